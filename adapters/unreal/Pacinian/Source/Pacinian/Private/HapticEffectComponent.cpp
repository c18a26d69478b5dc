#include "HapticEffectComponent.h"

#include <cmath>

#include "Emitted.h"
#include "Engine/World.h"
#include "Envelopes.h"
#include "GameFramework/Actor.h"
#include "HapticLink.h"
#include "HapticScene.h"
#include "HapticServerComponent.h"
#include "Motion.h"
#include "Outline.h"
#include "PacinianSettings.h"

namespace wire = pacinian::wire;

UHapticEffectComponent::UHapticEffectComponent() { bAutoActivate = true; }

void UHapticEffectComponent::BeginPlay() {
  Super::BeginPlay();
  Sent = MakeShared<FHapticBody>();
  const FString Made = GetOwner()->GetName() + TEXT(".") + GetName();
  Sent->Name = Haptic::Text((EffectName.IsEmpty() ? Made : EffectName).Right(64));
  Began = GetWorld()->GetTimeSeconds();
  if (UHapticScene* Scene = UHapticScene::Of(this)) Scene->Effects.AddUnique(this);
}

void UHapticEffectComponent::EndPlay(const EEndPlayReason::Type Reason) {
  Remove();
  if (UHapticScene* Scene = UHapticScene::Of(this)) Scene->Effects.Remove(this);
  Super::EndPlay(Reason);
}

void UHapticEffectComponent::Play() { Activate(true); }

void UHapticEffectComponent::Stop() { Deactivate(); }

bool UHapticEffectComponent::IsPlaying() const { return HasBegunPlay() && IsActive(); }

void UHapticEffectComponent::Activate(bool bReset) {
  const bool bAgain = bReset || !IsActive();
  Super::Activate(bReset);
  if (!bAgain) return;
  if (const UWorld* World = GetWorld()) Began = World->GetTimeSeconds();
  Refresh();
}

void UHapticEffectComponent::Deactivate() {
  Remove();
  Super::Deactivate();
}

void UHapticEffectComponent::SetRadiationPressure(float Pressure) {
  RadiationPressure = Pressure;
  Strength = EHapticStrength::RadiationPressure;
  Refresh();
}

void UHapticEffectComponent::SetForce(float NewForce) {
  Force = NewForce;
  Strength = EHapticStrength::Force;
  Refresh();
}

void UHapticEffectComponent::SetRelativeStrength(float Share) {
  SetRadiationPressure(FMath::Clamp(Share, 0.0f, 1.0f) * GetDefault<UPacinianSettings>()->FullPressure);
}

float UHapticEffectComponent::GetRelativeStrength() const {
  return FMath::Clamp(RadiationPressure / GetDefault<UPacinianSettings>()->FullPressure, 0.0f, 1.0f);
}

void UHapticEffectComponent::SetEnvelope(UHapticEnvelope* NewEnvelope) {
  Envelope = NewEnvelope;
  bEnveloped = true;
}

void UHapticEffectComponent::Refresh() { bReshaped = true; }

FString UHapticEffectComponent::GetProblem() const { return Complaint; }

float UHapticEffectComponent::GetEmitted() const {
  const TSharedPtr<FHapticLink> Link = Haptic::LinkOf(this);
  const wire::State* State = Haptic::Fresh(Link);
  return State && Sent ? Haptic::Strongest(*State, Sent->Name) : 0.0f;
}

FHapticRegionFelt UHapticEffectComponent::GetRegionFelt() const {
  const TSharedPtr<FHapticLink> Link = Haptic::LinkOf(this);
  const wire::State* State = Haptic::Fresh(Link);
  const pacinian::RegionFelt Felt = Sent ? pacinian::RegionFelt::of(State, Sent->Name) : pacinian::RegionFelt();
  FHapticRegionFelt Told;
  Told.bKnown = Felt.known();
  if (Told.bKnown) {
    Told.Force = Felt.force;
    Told.Rms = Felt.rms;
    Told.Holes = Felt.holes;
    Told.Spill = Felt.spill;
  }
  return Told;
}

#if WITH_EDITOR
void UHapticEffectComponent::PostEditChangeProperty(FPropertyChangedEvent& Event) {
  Super::PostEditChangeProperty(Event);
  Refresh();
}
#endif

void UHapticEffectComponent::Remove() {
  const UHapticScene* Scene = UHapticScene::Of(this);
  const UHapticServerComponent* Server = Scene ? Scene->GetServer() : nullptr;
  const TSharedPtr<FHapticLink> Link = Server ? Server->GetLink() : nullptr;
  if (bShown && Link && Session == Link->Session) Link->Client.remove(Sent->Name);
  bShown = false;
  Session = 0;
}

void UHapticEffectComponent::Send(const FHapticFrame& Frame) {
  if (!IsPlaying() || !Sent) return;
  if (Duration > 0.0f && GetWorld()->GetTimeSeconds() - Began >= Duration) {
    Deactivate();
    OnFinished.Broadcast();
    return;
  }
  const USceneComponent* Owner = GetShapeOwner();
  const bool bScaled = !Owner->GetComponentScale().Equals(Sent->Scale, 1e-4);
  const pacinian::Rigid Before = Sent->Pose, Now = Frame.Space.Into(Owner->GetComponentTransform());
  const uint64 Fingerprint = GetShapeFingerprint();
  if (Session != Frame.Session || bReshaped || bScaled || Fingerprint != Sent->Fingerprint) {
    Sent->Pose = Now;
    Sent->Scale = Owner->GetComponentScale();
    Sent->Fingerprint = Fingerprint;
    bReshaped = bEnveloped = bMoving = false;
    bShown = Put(Frame);
    Session = Frame.Session;
    return;
  }
  if (!bShown) return;
  if (bEnveloped) Frame.Client.envelope(Sent->Name, Haptic::ToWire(Envelope));
  bEnveloped = false;
  const bool bMoves = Haptic::Moved(Before, Now);
  if (!bMoves && !bMoving) return;
  Sent->Pose = Now;  // otherwise the last one that was sent, so that a slow movement adds up
  const wire::Motion Motion = Haptic::MotionOf(Before, Now, Frame.Elapsed);
  bMoving = bMoves && bPredictMotion;
  Frame.Client.move(Sent->Name, Haptic::ToWire(Sent->Pose), bMoving ? &Motion : nullptr);
}

bool UHapticEffectComponent::GetOutline(TArray<FVector>& Lines, FString& Problem) const {
  FHapticBody Body;
  const FTransform Place = GetShapeOwner()->GetComponentTransform();
  Body.Scale = Place.GetScale3D();
  if (!Describe(Body, Problem)) return false;
  Haptic::AddOutline(Body.Object, FHapticSpace::Metres(Place), Lines);
  return true;
}

bool UHapticEffectComponent::IsCalled(const FString& Wanted) const {
  return Sent && Sent->Name == Haptic::Text(Wanted);
}

void UHapticEffectComponent::Refuse(const FString& Path, const FString& Message) {
  const FString Objects(TEXT("$.objects["));
  if (!Sent || !Path.StartsWith(Objects, ESearchCase::CaseSensitive)) return;
  if (!Path.StartsWith(Objects + Haptic::Text(Sent->Name) + TEXT("]"), ESearchCase::CaseSensitive)) {
    bReshaped = true;
    return;
  }
  const uint32 Known = Session;
  Remove();
  Session = Known;
  Complaint = Message;
}

bool UHapticEffectComponent::Put(const FHapticFrame& Frame) {
  FString Problem;
  const bool bDescribed = Describe(*Sent, Problem);
  if (!bDescribed && Problem != Complaint)
    UE_LOG(LogPacinian, Warning, TEXT("%s cannot be felt: %s"), *GetName(), *Problem);
  Complaint = Problem;
  if (!bDescribed) {
    Remove();
    return false;
  }
  wire::HapticObject& Felt = Haptic::Placed(Sent->Object, Haptic::ToWire(Sent->Pose));
  if (Strength == EHapticStrength::Force)
    Felt.force = FMath::Clamp(Force, 0.0f, 1000.0f);
  else
    Felt.radiation_pressure = FMath::Clamp(RadiationPressure, 0.0f, 1e6f);
  Felt.envelope = Haptic::ToWire(Envelope);
  Felt.technique = Haptic::ToWire(Technique);
  Felt.priority = FMath::Clamp(Priority, -1000000, 1000000);
  Felt.material.reach = FMath::Clamp(0.01 * Reach, 0.0, 10.0);
  if (Stiffness > 0.0f) Felt.material.stiffness = Stiffness;
  if (Duration > 0.0f) Felt.duration = FMath::Max(1e-3, Duration - (GetWorld()->GetTimeSeconds() - Began));
  return Frame.Client.put(Sent->Name, MoveTemp(Sent->Object));
}
