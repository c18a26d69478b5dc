#pragma once

#include "CoreMinimal.h"

#include "HapticTouch.generated.h"

/** A hand that feels an effect, as the server renders it. */
USTRUCT(BlueprintType)
struct PACINIAN_API FHapticTouch {
  GENERATED_BODY()

  /** Name of the effect: its EffectName, or that of its actor and component. */
  UPROPERTY(BlueprintReadOnly, Category = "Haptics")
  FString Effect;

  /** Which hand: "left" or "right", unless another program that shares the scene has named it. */
  UPROPERTY(BlueprintReadOnly, Category = "Haptics")
  FString Hand;

  /** Middle of what is pressed on, in the level [cm]. */
  UPROPERTY(BlueprintReadOnly, Category = "Haptics")
  FVector Position = FVector::ZeroVector;

  /** Highest radiation pressure that is asked for, at full envelope [Pa]. */
  UPROPERTY(BlueprintReadOnly, Category = "Haptics")
  float Pressure = 0.0f;

  /** That pressure over the effect's own, 0 to 1. */
  UPROPERTY(BlueprintReadOnly, Category = "Haptics")
  float Strength = 0.0f;
};

DECLARE_DYNAMIC_MULTICAST_DELEGATE_OneParam(FHapticTouched, const FHapticTouch&, Touch);
