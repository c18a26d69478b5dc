#include "HapticHandComponent.h"

#include "Components/SceneComponent.h"
#include "Engine/Engine.h"
#include "Engine/World.h"
#include "GameFramework/Actor.h"
#include "GameFramework/PlayerController.h"
#include "HapticLink.h"
#include "HapticScene.h"
#include "HeadMountedDisplayTypes.h"
#include "IXRTrackingSystem.h"
#include "InputCoreTypes.h"
#include "OpenHand.h"

namespace wire = pacinian::wire;

namespace {

constexpr int32 Count = 26;        // joints
constexpr double MaxStepTime = 0.1;    // [s] longest time between two frames of one movement
constexpr double MaxSpeed = 10.0;  // [m/s]

}  // namespace

void UHapticHandComponent::BeginPlay() {
  Super::BeginPlay();
  if (UHapticScene* Scene = UHapticScene::Of(this)) Scene->Hands.AddUnique(this);
}

void UHapticHandComponent::EndPlay(const EEndPlayReason::Type Reason) {
  if (UHapticScene* Scene = UHapticScene::Of(this)) Scene->Hands.Remove(this);
  SentName.Reset();
  ShowCursor(nullptr);
  Super::EndPlay(Reason);
}

void UHapticHandComponent::SetJoints(const TArray<FVector>& Positions) {
  Joints = Positions;
  for (const FVector& Position : Joints)
    if (Position.ContainsNaN()) return SetLost();
}

void UHapticHandComponent::SetRadii(const TArray<float>& NewRadii) { Radii = NewRadii; }

void UHapticHandComponent::SetLeap(const TArray<FVector>& Bones, const TArray<float>& Widths, const FVector& Wrist) {
  TArray<FVector> Made;
  TArray<float> MadeRadii;
  if (!Haptic::LeapHand(Bones, Widths, Wrist, Made, MadeRadii)) return SetLost();
  SetJoints(Made);
  SetRadii(MadeRadii);
}

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

/// Sets an open hand. Offset: of its palm, in the actor's axes without its scale [cm].
void UHapticHandComponent::Open(const FVector& Offset) {
  const USceneComponent* Root = GetOwner()->GetRootComponent();
  const FTransform Actor = Root ? Root->GetComponentTransform() : FTransform::Identity;
  const FTransform Palm(Actor.GetRotation(), Actor.GetLocation() + Actor.GetRotation().RotateVector(Offset));
  Haptic::OpenHand(Palm, Side == EHapticSide::Left, Joints, Radii);
}

/// Shows the cursor of a player, without which the mouse has no position. Hides it again if the player is null or another.
void UHapticHandComponent::ShowCursor(APlayerController* Player) {
  if (Player && Player == CursorPlayer.Get()) return;
  if (CursorPlayer.IsValid()) CursorPlayer->bShowMouseCursor = false;
  CursorPlayer = Player && !Player->bShowMouseCursor ? Player : nullptr;
  if (CursorPlayer.IsValid()) CursorPlayer->bShowMouseCursor = true;
}

void UHapticHandComponent::FollowMouse() {
  SetLost();
  APlayerController* Player = GetWorld()->GetFirstPlayerController();
  ShowCursor(Player);
  if (!Player) return;
  float Right = 0.0f, Down = 0.0f;  // [pixels]
  int32 Width = 0, Height = 0;
  Player->GetViewportSize(Width, Height);
  const bool bKnown = Player->GetMousePosition(Right, Down) && Width > 0 && Height > 0;
  if (!bKnown || !Player->IsInputKeyDown(EKeys::LeftMouseButton)) return;
  Open(MouseReach * FVector(1.0f - 2.0f * Down / Height, 2.0f * Right / Width - 1.0f, 0.0f));
}

void UHapticHandComponent::Fill(FHapticHand& Hand, const FHapticSpace& Space) {
  if (Source == EHapticHandSource::Tracker) Track();
  if (Source == EHapticHandSource::Open) Open(FVector::ZeroVector);
  if (Source == EHapticHandSource::Mouse)
    FollowMouse();
  else
    ShowCursor(nullptr);
  wire::HandFrame& Frame = Hand.Frame;
  Frame.side = Side == EHapticSide::Left ? wire::HandFrameSide::left : wire::HandFrameSide::right;
  ChooseName();
  Frame.name = Haptic::Text(SentName);
  Frame.joints.clear();
  Frame.radii.clear();
  Frame.velocities.clear();
  if (!IsTracked()) {
    Time = -1.0;
    return;
  }
  for (const FVector& Joint : Joints) {
    const pacinian::Vec3 At = Space.Into(Joint);
    for (const double Value : {At.x, At.y, At.z}) wire::append(Frame.joints, static_cast<float>(Value));
  }
  Predict(Hand);
  if (Radii.Num() != Count) return;
  for (const float Radius : Radii)
    wire::append(Frame.radii, static_cast<float>(pacinian::unreal::metres * FMath::Clamp(Radius, 0.1f, 10.0f)));
}

/// Gives the hand a name that no other has: the side for the first hand of its side, "right 2" for the next. A hand keeps
/// it until its side changes.
void UHapticHandComponent::ChooseName() {
  const TCHAR* Own = Side == EHapticSide::Left ? TEXT("left") : TEXT("right");
  if (SentName.StartsWith(Own, ESearchCase::CaseSensitive)) return;
  const UHapticScene* Scene = UHapticScene::Of(this);
  const auto IsTaken = [&](const FString& Wanted) {
    for (const TObjectPtr<UHapticHandComponent>& Hand : Scene->Hands)
      if (Hand != this && Hand->SentName == Wanted) return true;
    return false;
  };
  FString Made = Own;
  for (int32 i = 2; Scene && IsTaken(Made); ++i) Made = FString::Printf(TEXT("%s %d"), Own, i);
  SentName = MoveTemp(Made);
}

/// Adds velocities to the hand, from the movement of its mean joint since the last frame.
void UHapticHandComponent::Predict(FHapticHand& Hand) {
  FVector Sum = FVector::ZeroVector;
  for (std::size_t i = 0; i < Count; ++i)
    Sum = Sum + FVector(wire::float_at(Hand.Frame.joints, 3 * i), wire::float_at(Hand.Frame.joints, 3 * i + 1),
                        wire::float_at(Hand.Frame.joints, 3 * i + 2));
  const double Now = GetWorld()->GetRealTimeSeconds(), Step = Now - Time;
  const FVector Moved = (1.0 / Count) * Sum - Middle;
  Middle = (1.0 / Count) * Sum;
  const bool bFollowed = Time >= 0.0 && Step > 0.0 && Step < MaxStepTime;
  Time = Now;
  if (!bPredictMotion || !bFollowed) return;
  const FVector Velocity = (1.0 / Step) * Moved;
  if (!(Velocity.Size() < MaxSpeed)) return;
  for (const double Value : {Velocity.X, Velocity.Y, Velocity.Z})
    wire::append(Hand.Frame.velocities, static_cast<float>(Value));
}
