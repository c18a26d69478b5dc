#include "Engine/Engine.h"
#include "GameFramework/Actor.h"
#include "HAL/IConsoleManager.h"
#include "HapticEffectComponent.h"
#include "HapticLink.h"
#include "HapticScene.h"
#include "HapticServerComponent.h"
#include "PacinianSettings.h"
#include "StartedServer.h"

using pacinian::wire::Output;

namespace {

#if !UE_BUILD_SHIPPING
TAutoConsoleVariable<bool> ShowsSilence(TEXT("pacinian.ShowSilence"), true, TEXT("Shows on the screen why nothing is felt."));
#endif

}  // namespace

bool UHapticServerComponent::IsConnected() const { return Link && Link->Session > 0; }

bool UHapticServerComponent::IsArmed() const { return Link && Link->Client.armed(); }

pacinian::Client* UHapticServerComponent::GetClient() const { return Link ? &Link->Client : nullptr; }

EHapticStatus UHapticServerComponent::GetStatus() const {
  if (!Link) return EHapticStatus::Stopped;
  switch (Link->Client.status()) {
    case pacinian::Status::stopped:
      break;
    case pacinian::Status::connecting:
      return EHapticStatus::Connecting;
    case pacinian::Status::connected:
      return EHapticStatus::Connected;
    case pacinian::Status::refused:
      return EHapticStatus::Refused;
  }
  return EHapticStatus::Stopped;
}

FString UHapticServerComponent::GetWaiting() const {
  const UHapticScene* Scene = UHapticScene::Of(this);
  const UHapticServerComponent* Used = Scene ? Scene->GetServer() : nullptr;
  return FString::Printf(TEXT("the Haptic Server of %s waits, because that of %s is used. Remove one of them; this one takes "
                              "over when the other is gone"),
                         *GetOwner()->GetName(), Used ? *Used->GetOwner()->GetName() : TEXT("no actor"));
}

FString UHapticServerComponent::GetProblem() const {
  if (!Unstopped.IsEmpty()) return Unstopped;
  if (bInReserve) return GetWaiting();
  if (IsConnected()) return Complaint;
  const FString Server = Haptic::ServerProblem();
  if (!Server.IsEmpty()) return Server;
  return Link ? Haptic::Text(Link->Client.problem()) : FString();
}

FString UHapticServerComponent::GetSilence() const {
  if (!IsConnected() && !GetProblem().IsEmpty()) return GetProblem();
  return Link ? Haptic::Text(Link->Client.silence().text) : FString(TEXT("not connected: call Connect"));
}

FString UHapticServerComponent::GetSilenceCause() const {
  return Link ? Haptic::Text(Link->Client.silence().cause) : FString(TEXT("not connected"));
}

/// Logs why there is no session when that changes, and which setting makes the editor too slow. Shows on the screen why
/// nothing is felt.
void UHapticServerComponent::Report() const {
  const FString Problem = IsConnected() ? FString() : Haptic::Text(Link->Client.problem());
  if (!Problem.IsEmpty() && Problem != Link->LoggedProblem) UE_LOG(LogPacinian, Warning, TEXT("Not connected: %s"), *Problem);
  Link->LoggedProblem = Problem;
#if WITH_EDITOR
  constexpr int32 Many = 3;  // frames
  const double Now = Link->Client.now();
  Link->LongFrames = IsConnected() && Now - Link->Reported > Link->Client.lease() ? Link->LongFrames + 1 : 0;
  Link->Reported = Now;
  if (Link->LongFrames == Many)
    UE_LOG(LogPacinian, Warning, TEXT("Frame after frame takes longer than the lease, so the array stays silent. In the background "
                                      "the editor draws few frames: in Editor Preferences, General, Performance, untick Use Less "
                                      "CPU when in Background"));
#endif
#if !UE_BUILD_SHIPPING
  if (!GEngine || !ShowsSilence.GetValueOnGameThread()) return;
  const FString Silence = GetSilence();
  if (!Silence.IsEmpty())  // for one frame
    GEngine->AddOnScreenDebugMessage(reinterpret_cast<uint64>(this), 0.0f, FColor::White, TEXT("Haptics: ") + Silence);
#endif
}

/// Forgets that an effect was refused as soon as no effect has a problem: the refused one was sent again, or is gone.
void UHapticServerComponent::ForgetRefusal(const UHapticScene& Scene) {
  if (!bRefusedEffect) return;
  for (const TObjectPtr<UHapticEffectComponent>& Effect : Scene.Effects)
    if (!Effect->GetProblem().IsEmpty()) return;
  bRefusedEffect = false;
  Complaint.Reset();
}

float UHapticServerComponent::GetLatency() const {
  return Link ? static_cast<float>(Link->Client.latency()) : 0.0f;
}

float UHapticServerComponent::GetGrantedLease() const { return Link ? static_cast<float>(Link->Client.lease()) : 0.0f; }

EHapticOutput UHapticServerComponent::GetOutput() const {
  const pacinian::wire::State* State = Link ? Link->Client.state() : nullptr;
  if (!State) return EHapticOutput::Unknown;
  switch (State->output) {
    case Output::silent:
      return EHapticOutput::Silent;
    case Output::sounding:
      return EHapticOutput::Sounding;
    case Output::stale:
      return EHapticOutput::Stale;
    case Output::stopped:
      return EHapticOutput::Stopped;
    case Output::faulted:
      return EHapticOutput::Faulted;
  }
  return EHapticOutput::Unknown;
}

TArray<FString> UHapticServerComponent::GetSolvers() const {
  TArray<FString> Names = GetDefault<UPacinianSettings>()->Solvers;
  Names.AddUnique(Solver);
  return Names;
}

TArray<FString> UHapticServerComponent::GetBackends() const {
  TArray<FString> Names = GetDefault<UPacinianSettings>()->Backends;
  Names.AddUnique(Backend);
  return Names;
}
