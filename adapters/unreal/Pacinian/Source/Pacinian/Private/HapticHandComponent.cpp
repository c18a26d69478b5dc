#include "HapticHandComponent.h"

#include "Engine/Engine.h"
#include "HapticScene.h"
#include "HeadMountedDisplayTypes.h"
#include "IXRTrackingSystem.h"
#include "Link.h"

namespace wire = pacinian::wire;

namespace {

constexpr int32 Count = 26;  // joints

}  // namespace

void UHapticHandComponent::BeginPlay() {
  Super::BeginPlay();
  if (UHapticScene* Scene = UHapticScene::Of(this)) Scene->Hands.AddUnique(this);
}

void UHapticHandComponent::EndPlay(const EEndPlayReason::Type Reason) {
  if (UHapticScene* Scene = UHapticScene::Of(this)) Scene->Hands.Remove(this);
  Super::EndPlay(Reason);
}

void UHapticHandComponent::SetJoints(const TArray<FVector>& Positions) {
  Joints = Positions;
  for (const FVector& Position : Joints)
    if (Position.ContainsNaN()) return SetLost();
}

void UHapticHandComponent::SetRadii(const TArray<float>& NewRadii) { Radii = NewRadii; }

void UHapticHandComponent::SetLost() { Joints.Reset(); }

bool UHapticHandComponent::IsTracked() const { return Joints.Num() == Count; }

void UHapticHandComponent::Track() {
  SetLost();
  if (!GEngine || !GEngine->XRSystem.IsValid()) return;
  FXRHandTrackingState State;
  const EControllerHand Hand = Side == EHapticSide::Left ? EControllerHand::Left : EControllerHand::Right;
  GEngine->XRSystem->GetHandTrackingState(this, EXRSpaceType::UnrealWorldSpace, Hand, State);
  if (!State.bValid || State.TrackingStatus != ETrackingStatus::Tracked) return;
  SetJoints(State.HandKeyLocations);
  SetRadii(State.HandKeyRadii);
}

void UHapticHandComponent::Fill(FHapticHand& Hand, const FHapticSpace& Space) {
  if (Source == EHapticHandSource::Tracker) Track();
  wire::HandFrame& Frame = Hand.Frame;
  Frame.side = Side == EHapticSide::Left ? wire::HandFrameSide::left : wire::HandFrameSide::right;
  Frame.joints.clear();
  Frame.radii.clear();
  if (!IsTracked()) return;
  for (const FVector& Joint : Joints) {
    const pacinian::Vec3 At = Space.Into(Joint);
    for (const double Value : {At.x, At.y, At.z}) wire::append(Frame.joints, static_cast<float>(Value));
  }
  if (Radii.Num() != Count) return;
  for (const float Radius : Radii)
    wire::append(Frame.radii, static_cast<float>(pacinian::unreal::metres * FMath::Clamp(Radius, 0.1f, 10.0f)));
}
