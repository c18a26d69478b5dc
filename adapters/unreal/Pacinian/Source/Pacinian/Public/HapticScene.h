#pragma once

#include "CoreMinimal.h"
#include "Subsystems/WorldSubsystem.h"

#include "HapticScene.generated.h"

class UArrayOriginComponent;
class UHapticEffectComponent;
class UHapticHandComponent;
class UHapticServerComponent;
class UQuietZoneComponent;

/** The active haptic components of a world, in the order in which they began. */
UCLASS()
class PACINIAN_API UHapticScene : public UWorldSubsystem {
  GENERATED_BODY()

 public:
  /** Returns the scene of an object's world; null if it has none. */
  static UHapticScene* Of(const UObject* Object);

  /** Returns the server component in use, which is the first; or null. */
  UFUNCTION(BlueprintPure, Category = "Haptics")
  UHapticServerComponent* GetServer() const;

  /** Returns the array origin in use, which is the first; null means the world's origin. */
  UFUNCTION(BlueprintPure, Category = "Haptics")
  UArrayOriginComponent* GetOrigin() const;

  UPROPERTY(Transient)
  TArray<TObjectPtr<UHapticServerComponent>> Servers;

  UPROPERTY(Transient)
  TArray<TObjectPtr<UArrayOriginComponent>> Origins;

  UPROPERTY(Transient)
  TArray<TObjectPtr<UHapticEffectComponent>> Effects;

  UPROPERTY(Transient)
  TArray<TObjectPtr<UHapticHandComponent>> Hands;

  UPROPERTY(Transient)
  TArray<TObjectPtr<UQuietZoneComponent>> Zones;
};
