#include "ArrayOriginComponent.h"

#include "ArrayAlignment.h"
#include "DrawDebugHelpers.h"
#include "Engine/World.h"
#include "HapticCalibration.h"
#include "HapticScene.h"
#include "Kismet/GameplayStatics.h"

UArrayOriginComponent::UArrayOriginComponent() {
  PrimaryComponentTick.bCanEverTick = true;
  PrimaryComponentTick.bTickEvenWhenPaused = true;  // the array sounds meanwhile
  PrimaryComponentTick.TickGroup = TG_PostUpdateWork;
}

void UArrayOriginComponent::BeginPlay() {
  Super::BeginPlay();
  if (UHapticScene* Scene = UHapticScene::Of(this)) Scene->Origins.AddUnique(this);
  if (bLoadOnStart) LoadCalibration();
}

void UArrayOriginComponent::EndPlay(const EEndPlayReason::Type Reason) {
  if (UHapticScene* Scene = UHapticScene::Of(this)) Scene->Origins.Remove(this);
  Super::EndPlay(Reason);
}

/// Returns the transform of the attach parent, without its scale.
FTransform UArrayOriginComponent::GetParent() const {
  const USceneComponent* Above = GetAttachParent();
  if (!Above) return FTransform::Identity;
  const FTransform Given = Above->GetComponentTransform();
  return FTransform(Given.GetRotation(), Given.GetLocation());
}

FString UArrayOriginComponent::GetSlot() const { return TEXT("Pacinian-") + CalibrationName; }

bool UArrayOriginComponent::BeginAlignment() {
  CancelAlignment();
  Points = KnownPoints.Num() > 0 ? KnownPoints : Haptic::Corners(this);
  return Points.Num() > 0;
}

bool UArrayOriginComponent::GetNextPoint(FVector& Point) const {
  if (Touched.Num() >= Points.Num()) return false;
  Point = Points[Touched.Num()];
  return true;
}

void UArrayOriginComponent::TouchPoint(const FVector& Position) {
  if (Touched.Num() < Points.Num()) Touched.Add(GetParent().InverseTransformPosition(Position));
}

int32 UArrayOriginComponent::GetTouched() const { return Touched.Num(); }

bool UArrayOriginComponent::FinishAlignment(FString& Problem) {
  FTransform Found;
  if (!Haptic::Align(Points, Touched, Found, Residual, Worst, Problem)) return false;
  const FTransform Placed = Found * GetParent();
  SetWorldLocationAndRotation(Placed.GetLocation(), Placed.GetRotation());
  CancelAlignment();
  return true;
}

void UArrayOriginComponent::CancelAlignment() {
  Points.Reset();
  Touched.Reset();
}

float UArrayOriginComponent::GetResidual() const { return static_cast<float>(Residual); }

float UArrayOriginComponent::GetWorst() const { return static_cast<float>(Worst); }

bool UArrayOriginComponent::SaveCalibration() {
  UHapticCalibration* Kept = NewObject<UHapticCalibration>(this);
  Kept->Origin = GetComponentTransform().GetRelativeTransform(GetParent());
  Kept->Residual = Residual;
  Kept->Worst = Worst;
  return UGameplayStatics::SaveGameToSlot(Kept, GetSlot(), 0);
}

bool UArrayOriginComponent::LoadCalibration() {
  if (!UGameplayStatics::DoesSaveGameExist(GetSlot(), 0)) return false;
  const auto* Kept = Cast<UHapticCalibration>(UGameplayStatics::LoadGameFromSlot(GetSlot(), 0));
  if (!Kept) return false;
  const FTransform Placed = Kept->Origin * GetParent();
  SetWorldLocationAndRotation(Placed.GetLocation(), Placed.GetRotation());
  Residual = Kept->Residual;
  Worst = Kept->Worst;
  return true;
}

void UArrayOriginComponent::ForgetCalibration() { UGameplayStatics::DeleteGameInSlot(GetSlot(), 0); }

void UArrayOriginComponent::TickComponent(float DeltaTime, ELevelTick TickType, FActorComponentTickFunction* Tick) {
  Super::TickComponent(DeltaTime, TickType, Tick);
#if ENABLE_DRAW_DEBUG
  if (!bDrawArray) return;
  DrawDebugCoordinateSystem(GetWorld(), GetComponentLocation(), GetComponentRotation(), 10.0f);
  const TArray<FVector> Corners = Haptic::Corners(this);
  for (int32 i = 0; i < Corners.Num(); ++i)
    DrawDebugLine(GetWorld(), GetComponentTransform().TransformPositionNoScale(Corners[i]),
                  GetComponentTransform().TransformPositionNoScale(Corners[(i + 1) % Corners.Num()]), FColor::Cyan);
#endif
}
