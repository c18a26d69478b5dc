#pragma once

#include "HapticTouch.h"
#include "Link.h"

class UObject;

namespace Haptic {

/** The connection of an object's world, or null. */
TSharedPtr<FHapticLink> LinkOf(const UObject* Object);

/** What is emitted now; null if nothing is known of it. */
const pacinian::wire::State* Fresh(const TSharedPtr<FHapticLink>& Link);

/** Samples; none where it does not sound. */
std::size_t Samples(const pacinian::wire::State& State);

/** A place or direction of some. */
pacinian::Vec3 At(const pacinian::wire::Bytes& Rows, std::size_t i);

/** The largest radiation pressure that is emitted for an object [Pa]; 0 if none is. */
float Strongest(const pacinian::wire::State& State, const std::string& Name);

/** A touch in the level. */
FHapticTouch ToTouch(const pacinian::wire::TouchState& Told, const FHapticSpace& Space);

}  // namespace Haptic
