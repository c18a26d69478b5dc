#include "HapticScene.h"

#include "ArrayOriginComponent.h"
#include "Engine/World.h"
#include "HapticEffectComponent.h"
#include "HapticHandComponent.h"
#include "HapticServerComponent.h"
#include "QuietZoneComponent.h"

UHapticScene* UHapticScene::Of(const UObject* Object) {
  const UWorld* World = Object ? Object->GetWorld() : nullptr;
  return World ? World->GetSubsystem<UHapticScene>() : nullptr;
}

UHapticServerComponent* UHapticScene::GetServer() const {
  return Servers.Num() > 0 ? Servers[0].Get() : nullptr;
}

UArrayOriginComponent* UHapticScene::GetOrigin() const {
  return Origins.Num() > 0 ? Origins[0].Get() : nullptr;
}
