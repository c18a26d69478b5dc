#pragma once

#include "CoreIncludes.h"

class UHapticEnvelope;
struct FHapticTechnique;

namespace Haptic {

/** Converts an envelope to the wire's; null becomes a constant envelope. */
pacinian::wire::Envelope ToWire(const UHapticEnvelope* Envelope);

/** Converts a technique to the wire's; none means the server's default. */
std::optional<pacinian::wire::Technique> ToWire(const FHapticTechnique& Given);

}  // namespace Haptic
