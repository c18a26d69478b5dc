#pragma once

#include "Core.h"

class UHapticEnvelope;

namespace Haptic {

/** As the server knows it; the same at all times for none. */
pacinian::wire::Envelope ToWire(const UHapticEnvelope* Envelope);

}  // namespace Haptic
