#include "HapticEffectComponent.h"

#include "Emitted.h"
#include "Engine/World.h"
#include "Envelopes.h"
#include "GameFramework/Actor.h"
#include "HapticLink.h"
#include "HapticScene.h"
#include "HapticServerComponent.h"
#include "Outline.h"
#include "PacinianSettings.h"

namespace wire = pacinian::wire;

UHapticEffectComponent::UHapticEffectComponent() { bAutoActivate = true; }

void UHapticEffectComponent::BeginPlay() {
  Super::BeginPlay();
  Sent = MakeShared<FHapticBody>();
  Sent->Name = Haptic::Text(MakeName());
  Began = GetWorld()->GetRealTimeSeconds();
  if (UHapticScene* Scene = UHapticScene::Of(this)) Scene->Effects.AddUnique(this);
}

/// Returns a name that no other effect of the world has: the wanted one, or with a number, as in "ball 2".
FString UHapticEffectComponent::MakeName() const {
  const FString Wanted = EffectName.IsEmpty() ? GetOwner()->GetName() + TEXT(".") + GetName() : EffectName;
  const UHapticScene* Scene = UHapticScene::Of(this);
  const auto IsTaken = [&](const FString& Given) {
    for (const TObjectPtr<UHapticEffectComponent>& Effect : Scene->Effects)
      if (Effect != this && Effect->IsCalled(Given)) return true;
    return false;
  };
  FString Made = Wanted.Right(64);
  for (int32 i = 2; Scene && IsTaken(Made); ++i) Made = FString::Printf(TEXT("%s %d"), *Wanted.Right(58), i);
  return Made;
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
  if (const UWorld* World = GetWorld()) Began = World->GetRealTimeSeconds();
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

bool UHapticEffectComponent::GetOutline(TArray<FVector>& Lines, FString& Problem) const {
  FHapticBody Body;
  const FTransform Place = GetShapeTransform();
  Body.Scale = Place.GetScale3D();
  if (!Describe(Body, Problem)) return false;
  Haptic::AddOutline(Body.Object, FHapticSpace::Metres(Place), Lines);
  return true;
}

bool UHapticEffectComponent::IsCalled(const FString& Wanted) const {
  return Sent && Sent->Name == Haptic::Text(Wanted);
}
