#pragma once

#include "Core.h"

class UHapticEnvelope;
struct FHapticTechnique;

namespace Haptic {

/** As the server knows it; the same at all times for none. */
pacinian::wire::Envelope ToWire(const UHapticEnvelope* Envelope);

/** As the server knows it; none: the server's. */
std::optional<pacinian::wire::Technique> ToWire(const FHapticTechnique& Given);

}  // namespace Haptic
