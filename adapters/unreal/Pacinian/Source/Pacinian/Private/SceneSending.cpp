#include "SceneSending.h"

#include <algorithm>

#include "HapticHandComponent.h"
#include "HapticScene.h"
#include "Motion.h"
#include "QuietZoneComponent.h"

THIRD_PARTY_INCLUDES_START
#include "pacinian/wire/protocol.h"
THIRD_PARTY_INCLUDES_END

namespace wire = pacinian::wire;

namespace Haptic {

namespace {

constexpr float LowestPressure = 0.1f, HighestPressure = 1e6f;  // [Pa]

bool Same(const wire::Zone& A, const wire::Zone& B) {
  return A.position == B.position && A.pressure == B.pressure && A.radius == B.radius;
}

}  // namespace

void SendHands(FHapticLink& Link, UHapticScene& Scene) {
  const bool bSent = Link.HandsSession == Link.Session;
  if (Scene.Hands.Num() == 0 && !(bSent && Link.Hands.size() > 0)) return;
  Link.Hands.resize(std::min<std::size_t>(Scene.Hands.Num(), wire::MAX_HANDS));
  for (std::size_t i = 0; i < Link.Hands.size(); ++i) {
    FHapticHand Hand{Link.Hands[i]};
    Scene.Hands[static_cast<int32>(i)]->Fill(Hand, Link.Space);
  }
  Link.Client.hands(Link.Hands);
  Link.HandsSession = Link.Session;
}

void SendZones(FHapticLink& Link, UHapticScene& Scene) {
  Link.Zones.resize(std::min<std::size_t>(Scene.Zones.Num(), wire::MAX_ZONES));
  for (std::size_t i = 0; i < Link.Zones.size(); ++i) {
    const UQuietZoneComponent& Given = *Scene.Zones[static_cast<int32>(i)];
    wire::Zone& Zone = Link.Zones[i];
    Zone.position = ToWire(Link.Space.Into(Given.GetComponentLocation()));
    // What is not a number protects most.
    Zone.pressure = Given.Pressure > LowestPressure ? FMath::Clamp(Given.Pressure, LowestPressure, HighestPressure) : LowestPressure;
    Zone.radius = Given.Radius < 100.0f ? FMath::Clamp(0.01 * Given.Radius, 0.0, 1.0) : 1.0;
  }
  if (Link.ZonesSession != Link.Session || Link.ZonesDue <= Link.Client.now()) Link.SentZones.clear();
  Link.ZonesSession = Link.Session;
  const auto& Sent = Link.SentZones;
  if (std::equal(Sent.begin(), Sent.end(), Link.Zones.begin(), Link.Zones.end(), Same)) return;
  if (!Link.Client.quiet(Link.Zones)) return;
  Link.SentZones = Link.Zones;
  Link.ZonesDue = FHapticLink::Never;
}

void RefuseZones(FHapticLink& Link, const FString& Code, const FString& Path) {
  constexpr double Pause = 1.0;  // [s]
  const bool bTooMany = Path == FString(TEXT("$.zones")) && Code == FString(TEXT("limit"));  // until others remove theirs
  if (bTooMany || Path == FString(TEXT("$.ttl"))) Link.ZonesDue = Link.Client.now() + Pause;
}

}  // namespace Haptic
