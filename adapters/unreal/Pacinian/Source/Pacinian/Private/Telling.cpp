#include "Telling.h"

#include <algorithm>

#include "HapticHandComponent.h"
#include "HapticScene.h"
#include "HapticServerComponent.h"
#include "Misc/App.h"
#include "PacinianSettings.h"
#include "QuietZoneComponent.h"

THIRD_PARTY_INCLUDES_START
#include "pacinian/wire/protocol.h"
THIRD_PARTY_INCLUDES_END

namespace wire = pacinian::wire;

namespace Haptic {

namespace {

constexpr int32 Longest = 64;      // characters of a name
constexpr double Farthest = 10.0;  // [m]

bool Same(const wire::Zone& A, const wire::Zone& B) {
  return A.position == B.position && A.pressure == B.pressure && A.radius == B.radius;
}

TArray<FString> Names(const std::vector<wire::Plugin>& Plugins) {
  TArray<FString> Made;
  Made.Add(FString());
  for (const wire::Plugin& Plugin : Plugins) Made.Add(Text(Plugin.name));
  return Made;
}

}  // namespace

pacinian::Options Wanted(const UHapticServerComponent& Server) {
  pacinian::Options Options;
  const FString Name = Server.ClientName.IsEmpty() ? FString(FApp::GetProjectName()) : Server.ClientName;
  Options.connection_path = Text(Server.ConnectionFile);
  Options.name = Text(Name.IsEmpty() ? FString(TEXT("Unreal")) : Name.Left(Longest));
  Options.scene = Text(Server.SceneName.Left(Longest));
  Options.version = "Unreal";
  if (Server.Lease > 0.0f) Options.lease = FMath::Clamp(Server.Lease, 0.02f, 10.0f);
  return Options;
}

void Remember(FHapticLink& Link) {
  const wire::Abilities* Abilities = Link.Client.capabilities();
  if (!Abilities || Link.ListedSession == Link.Session) return;
  Link.ListedSession = Link.Session;
  UPacinianSettings* Settings = GetMutableDefault<UPacinianSettings>();
  Settings->Solvers = Names(Abilities->solvers);
  Settings->Backends = Names(Abilities->backends);
}

void TellHands(FHapticLink& Link, UHapticScene& Scene) {
  const bool bTold = Link.HandsSession == Link.Session;
  if (Scene.Hands.Num() == 0 && !(bTold && Link.Hands.size() > 0)) return;
  Link.Hands.resize(std::min<std::size_t>(Scene.Hands.Num(), wire::MAX_HANDS));
  for (std::size_t i = 0; i < Link.Hands.size(); ++i) {
    FHapticHand Hand{Link.Hands[i]};
    Scene.Hands[static_cast<int32>(i)]->Fill(Hand, Link.Space);
  }
  Link.Client.hands(Link.Hands);
  Link.HandsSession = Link.Session;
}

void TellZones(FHapticLink& Link, UHapticScene& Scene) {
  Link.Zones.resize(std::min<std::size_t>(Scene.Zones.Num(), wire::MAX_ZONES));
  for (std::size_t i = 0; i < Link.Zones.size(); ++i) {
    const UQuietZoneComponent& Given = *Scene.Zones[static_cast<int32>(i)];
    const pacinian::Vec3 Place = Link.Space.Into(Given.GetComponentLocation());
    wire::Zone& Zone = Link.Zones[i];
    Zone.position = {FMath::Clamp(Place.x, -Farthest, Farthest), FMath::Clamp(Place.y, -Farthest, Farthest),
                     FMath::Clamp(Place.z, -Farthest, Farthest)};
    Zone.pressure = FMath::Max(0.0f, Given.Pressure);
    Zone.radius = FMath::Clamp(0.01 * Given.Radius, 0.0, 1.0);
  }
  if (Link.ZonesSession != Link.Session) Link.SentZones.clear();
  Link.ZonesSession = Link.Session;
  const auto& Sent = Link.SentZones;
  if (std::equal(Sent.begin(), Sent.end(), Link.Zones.begin(), Link.Zones.end(), Same)) return;
  if (Link.Client.quiet(Link.Zones)) Link.SentZones = Link.Zones;
}

}  // namespace Haptic
