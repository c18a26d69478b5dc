#include "HapticServerComponent.h"

#include "ArrayOriginComponent.h"
#include "Emitted.h"
#include "HapticEffectComponent.h"
#include "HapticLink.h"
#include "HapticScene.h"
#include "Misc/CoreDelegates.h"
#include "SceneSending.h"
#include "StartedServer.h"

namespace wire = pacinian::wire;

UHapticServerComponent::UHapticServerComponent() {
  PrimaryComponentTick.bCanEverTick = true;
  PrimaryComponentTick.bTickEvenWhenPaused = true;       // a paused game is alive
  PrimaryComponentTick.TickGroup = TG_PostUpdateWork;  // after all movement
}

void UHapticServerComponent::BeginPlay() {
  Super::BeginPlay();
  if (GetNetMode() == NM_DedicatedServer) return SetComponentTickEnabled(false);  // it has no player; clients connect
  UHapticScene* Scene = UHapticScene::Of(this);
  if (Scene) Scene->Servers.AddUnique(this);
  Exit = FCoreDelegates::OnEnginePreExit.AddUObject(this, &UHapticServerComponent::Disconnect);
  bInReserve = Scene && Scene->GetServer() != this;
  if (bInReserve) {
    UE_LOG(LogPacinian, Log, TEXT("%s"), *GetWaiting());
    return;
  }
  Start();
}

/// Starts this component, also when the one in use before is gone.
void UHapticServerComponent::Start() {
  bInReserve = false;
  FString Problem;
  if (bStartServer) StartServer(Problem);
  if (bConnectOnPlay) Connect();
}

void UHapticServerComponent::EndPlay(const EEndPlayReason::Type Reason) {
  Disconnect();
  FCoreDelegates::OnEnginePreExit.Remove(Exit);
  if (UHapticScene* Scene = UHapticScene::Of(this)) Scene->Servers.Remove(this);
  Super::EndPlay(Reason);
}

void UHapticServerComponent::BeginDestroy() {
  Disconnect();
  Super::BeginDestroy();
}

void UHapticServerComponent::Connect() {
  const UHapticScene* Scene = UHapticScene::Of(this);
  if (!HasBegunPlay() || !Scene || Scene->GetServer() != this) {
    const FString Why = HasBegunPlay() ? GetWaiting() : FString(TEXT("press Play first"));
    UE_LOG(LogPacinian, Warning, TEXT("%s does not connect: %s"), *GetName(), *Why);
    return;
  }
  Disconnect();
  bFirstSession = true;
  bWantsSound = false;
  Link = MakeShared<FHapticLink>(Haptic::MakeOptions(*this));
  pacinian::Events& On = Link->Client.on;
  On.connected = [this] { Begun(); };
  On.lost = [this](const std::string& Why) {
    if (Link) Link->Session = 0;
    UE_LOG(LogPacinian, Warning, TEXT("Connection lost: %s"), *Haptic::Text(Why));
    OnLost.Broadcast(Haptic::Text(Why));
  };
  On.ended = [this](const pacinian::Refusal& Told) { Ended(Haptic::Text(Told.code), Haptic::Text(Told.message)); };
  On.refused = [this](const pacinian::Refusal& Told) { Refused(Told); };
  On.state_changed = [this](const wire::State&) { OnStateChanged.Broadcast(); };
  On.touch_began = [this](const wire::TouchState& Told) {
    if (Link) Touched(Haptic::ToTouch(Told, Link->Space), true);
  };
  On.touch_moved = [this](const wire::TouchState& Told) {
    if (Link) OnTouchMoved.Broadcast(Haptic::ToTouch(Told, Link->Space));
  };
  On.touch_ended = [this](const wire::TouchState& Told) {
    if (Link) Touched(Haptic::ToTouch(Told, Link->Space), false);
  };
  On.stood_still = [this](const pacinian::Standstill& Told) {
    UE_LOG(LogPacinian, Log, TEXT("%s"), *Haptic::Text(Told.text()));
    OnStoodStill.Broadcast(static_cast<float>(Told.seconds), Told.whole);
  };
  Link->Client.start();
}

void UHapticServerComponent::Refused(const pacinian::Refusal& Told) {
  const FString Code = Haptic::Text(Told.code), Message = Haptic::Text(Told.message), Path = Haptic::Text(Told.path);
  const FString Before = MoveTemp(Complaint);
  Complaint = Haptic::Text(Told.text());
  bRefusedEffect = Path.StartsWith(TEXT("$.objects"), ESearchCase::CaseSensitive);
  if (Told.code == "stop") Unstopped = Complaint;
  if (Complaint != Before) UE_LOG(LogPacinian, Warning, TEXT("Refused: %s"), *Complaint);
  if (Link) Haptic::RefuseZones(*Link, Code, Path);
  if (const UHapticScene* Scene = UHapticScene::Of(this))
    for (const TObjectPtr<UHapticEffectComponent>& Effect : Scene->Effects) Effect->Refuse(Path, Message);
  OnRefused.Broadcast(Code, Message, Haptic::Text(Told.advice));
}

void UHapticServerComponent::Reconnect() { Connect(); }

void UHapticServerComponent::Disconnect() {
  const TSharedPtr<FHapticLink> Held = MoveTemp(Link);
  Link.Reset();
  if (!Held) return;
  const std::vector<wire::TouchState> Touches = Held->Client.touches();
  Held->Client.close();
  for (const wire::TouchState& Told : Touches) Touched(Haptic::ToTouch(Told, Held->Space), false);
}

void UHapticServerComponent::Touched(const FHapticTouch& Touch, bool bBegins) {
  (bBegins ? OnTouchBegan : OnTouchEnded).Broadcast(Touch);
  const UHapticScene* Scene = UHapticScene::Of(this);
  if (!Scene) return;
  const TArray<TObjectPtr<UHapticEffectComponent>> Effects = Scene->Effects;  // a handler may change the scene
  for (const TObjectPtr<UHapticEffectComponent>& Effect : Effects)
    if (Effect->IsCalled(Touch.Effect)) (bBegins ? Effect->OnTouchBegan : Effect->OnTouchEnded).Broadcast(Touch);
}

/// Handles a new session, whose scene is empty. The components put their objects when they see a new session number.
void UHapticServerComponent::Begun() {
  static uint32 Sessions = 0;
  if (!Link) return;
  Link->Session = ++Sessions;
  Complaint.Reset();
  Unstopped.Reset();
  Choose(true, true, true);
  if (bFirstSession ? bArmOnConnect : bArmAgainAfterLoss && bWantsSound) Arm();
  bFirstSession = false;
  UE_LOG(LogPacinian, Log, TEXT("Connected to %s"), *Haptic::Text(Link->Client.server()));
  OnConnected.Broadcast();
}

void UHapticServerComponent::Ended(const FString& Code, const FString& Message) {
  UE_LOG(LogPacinian, Warning, TEXT("Sound has ended (%s): %s"), *Code, *Message);
  bWantsSound = false;
  OnEnded.Broadcast(Code, Message);
}

bool UHapticServerComponent::Arm() {
  bWantsSound = Link && Link->Client.arm(bTakeOver);
  return bWantsSound;
}

void UHapticServerComponent::Disarm() {
  bWantsSound = false;
  if (Link) Link->Client.disarm();
}

void UHapticServerComponent::EmergencyStop() {
  bWantsSound = false;
  Unstopped.Reset();
  if (!Link) {
    Link = MakeShared<FHapticLink>(Haptic::MakeOptions(*this));
    Link->Client.on.refused = [this](const pacinian::Refusal& Told) { Refused(Told); };
  }
  // Told from its own thread: there is no tick in an editor that does not play.
  Link->Client.stop([](const pacinian::Refusal& Told) { UE_LOG(LogPacinian, Error, TEXT("%s"), *Haptic::Text(Told.text())); });
}

void UHapticServerComponent::ResetOutput() {
  Unstopped.Reset();
  if (Link) Link->Client.reset();
}

void UHapticServerComponent::TickComponent(float DeltaTime, ELevelTick TickType, FActorComponentTickFunction* Tick) {
  Super::TickComponent(DeltaTime, TickType, Tick);
  UHapticScene* Scene = UHapticScene::Of(this);
  if (bInReserve && Scene && Scene->GetServer() == this) Start();
  if (bInReserve) return;
  Haptic::TickServer(IsConnected());
  const TSharedPtr<FHapticLink> Held = Link;  // a handler may disconnect
  if (!Held) return;
  Held->Client.tick();
  if (Link == Held) Report();
  if (Link != Held || !IsConnected() || !Scene) return;
  Haptic::ListPlugins(*Held);
  const UArrayOriginComponent* Origin = Scene->GetOrigin();
  Held->Space = Origin ? FHapticSpace(Origin->GetComponentTransform()) : FHapticSpace();
  Haptic::SendHands(*Held, *Scene);
  Haptic::SendZones(*Held, *Scene);
  const double Now = Held->Client.now();  // DeltaTime is dilated
  const FHapticFrame Frame{Held->Client, Held->Space, Held->Session, Now - Held->Ticked};
  Held->Ticked = Now;
  for (int32 i = Scene->Effects.Num() - 1; i >= 0; --i)
    if (i < Scene->Effects.Num()) Scene->Effects[i]->Send(Frame);
  ForgetRefusal(*Scene);
}
