#include "HapticLink.h"
#include "HapticServerComponent.h"
#include "Misc/App.h"
#include "PacinianSettings.h"

namespace wire = pacinian::wire;

namespace Haptic {

namespace {

constexpr int32 LongestName = 64;  // characters of a name

TArray<FString> Names(const std::vector<wire::Plugin>& Plugins) {
  TArray<FString> Made;
  Made.Add(FString());
  for (const wire::Plugin& Plugin : Plugins) Made.Add(Text(Plugin.name));
  return Made;
}

}  // namespace

pacinian::Options MakeOptions(const UHapticServerComponent& Server) {
  pacinian::Options Options;
  const FString Name = Server.ClientName.IsEmpty() ? FString(FApp::GetProjectName()) : Server.ClientName;
  Options.connection_path = Text(Server.ConnectionFile);
  Options.name = Text(Name.IsEmpty() ? FString(TEXT("Unreal")) : Name.Left(LongestName));
  Options.scene = Text(Server.SceneName.Left(LongestName));
  Options.version = "Unreal";
  if (Server.Lease > 0.0f) Options.lease = FMath::Clamp(Server.Lease, 0.05f, 10.0f);
  return Options;
}

void ListPlugins(FHapticLink& Link) {
  const wire::Abilities* Abilities = Link.Client.capabilities();
  if (!Abilities || Link.ListedSession == Link.Session) return;
  Link.ListedSession = Link.Session;
  UPacinianSettings* Settings = GetMutableDefault<UPacinianSettings>();
  Settings->Solvers = Names(Abilities->solvers);
  Settings->Backends = Names(Abilities->backends);
}

}  // namespace Haptic

void UHapticServerComponent::SetIntensity(float NewIntensity) {
  Intensity = FMath::Clamp(NewIntensity, 0.0f, 1.0f);
  Choose(true, false, false);
}

void UHapticServerComponent::SetSolver(const FString& NewSolver) {
  Solver = NewSolver;
  Choose(false, true, false);
}

void UHapticServerComponent::SetBackend(const FString& NewBackend) {
  Backend = NewBackend;
  Choose(false, false, true);
}

void UHapticServerComponent::Choose(bool bIntensity, bool bSolver, bool bBackend) {
  if (!IsConnected()) return;
  wire::Select Choice;
  if (bIntensity) Choice.intensity = FMath::Clamp(Intensity, 0.0f, 1.0f);
  if (bSolver && !Solver.IsEmpty()) Choice.solver = wire::Choice{Haptic::Text(Solver), {}};
  if (bBackend && !Backend.IsEmpty()) Choice.backend = wire::Choice{Haptic::Text(Backend), {}};
  if (Choice.intensity || Choice.solver || Choice.backend) Link->Client.select(MoveTemp(Choice));
}

#if WITH_EDITOR
void UHapticServerComponent::PostEditChangeProperty(FPropertyChangedEvent& Event) {
  Super::PostEditChangeProperty(Event);
  const FName Changed = Event.GetPropertyName();
  Choose(Changed == GET_MEMBER_NAME_CHECKED(UHapticServerComponent, Intensity),
         Changed == GET_MEMBER_NAME_CHECKED(UHapticServerComponent, Solver),
         Changed == GET_MEMBER_NAME_CHECKED(UHapticServerComponent, Backend));
}
#endif
