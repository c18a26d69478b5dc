#include "HapticTechnique.h"

#include "Envelopes.h"

namespace wire = pacinian::wire;

namespace Haptic {

std::optional<wire::Technique> ToWire(const FHapticTechnique& Given) {
  const double Frequency = FMath::Clamp(Given.Frequency, 0.1f, 20000.0f);
  switch (Given.Kind) {
    case EHapticTechnique::Simultaneous:
      return wire::Simultaneous{};
    case EHapticTechnique::AM:
      return wire::AM{Frequency, FMath::Clamp(Given.Depth, 0.0f, 1.0f)};
    case EHapticTechnique::STM:
      return wire::STM{Frequency, Given.bOutline ? wire::RouteWord::outline : wire::RouteWord::samples, {}};
    case EHapticTechnique::LM:  // x and y change places
      return wire::LM{Frequency, 0.01 * FMath::Clamp(Given.Amplitude, 0.01f, 2.0f), 90.0 - Given.Angle};
    case EHapticTechnique::Server:
      break;
  }
  return std::nullopt;
}

}  // namespace Haptic
