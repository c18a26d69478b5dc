#pragma once

#include "HapticLink.h"
#include "HapticTouch.h"

class UObject;

namespace Haptic {

/** Returns the connection of an object's world, or null. */
TSharedPtr<FHapticLink> LinkOf(const UObject* Object);

/** Returns the present state; null if there is none, or if it is too old. */
const pacinian::wire::State* Fresh(const TSharedPtr<FHapticLink>& Link);

/** Returns the number of samples; 0 unless the output sounds. */
std::size_t Samples(const pacinian::wire::State& State);

/** Returns a row of an array of positions or directions. */
pacinian::Vec3 At(const pacinian::wire::Bytes& Rows, std::size_t i);

/** Returns the largest radiation pressure emitted for an object [Pa]; 0 if there is none. */
float Strongest(const pacinian::wire::State& State, const std::string& Name);

/** Converts a touch to the level's frame. */
FHapticTouch ToTouch(const pacinian::wire::TouchState& Told, const FHapticSpace& Space);

}  // namespace Haptic
