#include "QuietZoneComponent.h"

#include "HapticScene.h"

void UQuietZoneComponent::BeginPlay() {
  Super::BeginPlay();
  if (UHapticScene* Scene = UHapticScene::Of(this)) Scene->Zones.AddUnique(this);
}

void UQuietZoneComponent::EndPlay(const EEndPlayReason::Type Reason) {
  if (UHapticScene* Scene = UHapticScene::Of(this)) Scene->Zones.Remove(this);
  Super::EndPlay(Reason);
}
