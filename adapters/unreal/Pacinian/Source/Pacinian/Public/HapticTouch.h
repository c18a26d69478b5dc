#pragma once

#include "CoreMinimal.h"

#include "HapticTouch.generated.h"

/** A hand that feels an effect, as the server renders it. */
USTRUCT(BlueprintType)
struct PACINIAN_API FHapticTouch {
  GENERATED_BODY()

  /** The name of the effect: its EffectName, or the name derived from its actor and component. */
  UPROPERTY(BlueprintReadOnly, Category = "Haptics")
  FString Effect;

  /** The hand: "left" or "right", with a number for further hands of one side ("right 2"). Another client that shares the
   * scene may have named it otherwise. */
  UPROPERTY(BlueprintReadOnly, Category = "Haptics")
  FString Hand;

  /** The middle of the contact, in the level [cm]. */
  UPROPERTY(BlueprintReadOnly, Category = "Haptics")
  FVector Position = FVector::ZeroVector;

  /** The highest requested radiation pressure, at the full level of the envelope [Pa]. */
  UPROPERTY(BlueprintReadOnly, Category = "Haptics")
  float Pressure = 0.0f;

  /** The pressure relative to the effect's own, 0 to 1. */
  UPROPERTY(BlueprintReadOnly, Category = "Haptics")
  float Strength = 0.0f;
};

DECLARE_DYNAMIC_MULTICAST_DELEGATE_OneParam(FHapticTouched, const FHapticTouch&, Touch);
