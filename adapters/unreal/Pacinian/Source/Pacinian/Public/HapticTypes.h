#pragma once

#include "CoreMinimal.h"

#include "HapticTypes.generated.h"

/** How the game stands with its haptic server. */
UENUM(BlueprintType)
enum class EHapticStatus : uint8 {
  /** Not connected, and not asked to be. */
  Stopped,
  /** No server yet, or none any more: it is tried again and again. */
  Connecting,
  Connected,
  /** The server will not have us until something is changed: see Get Problem. */
  Refused,
};

/** What the array does, as the server says. */
UENUM(BlueprintType)
enum class EHapticOutput : uint8 {
  /** No server has told. */
  Unknown,
  /** No client has armed the output, or there is nothing to feel. */
  Silent,
  /** Something can be felt. */
  Sounding,
  /** The renderer is late: silent until it goes on. */
  Stale,
  /** After an emergency stop, until Reset Output. */
  Stopped,
  /** A plug-in or device failed, until Reset Output. */
  Faulted,
};

/** What is given of an effect's strength. */
UENUM(BlueprintType)
enum class EHapticStrength : uint8 {
  /** Radiation pressure, everywhere the same. */
  RadiationPressure,
  /** A force, over the whole of it. */
  Force,
};

/** Which hand. */
UENUM(BlueprintType)
enum class EHapticSide : uint8 { Left, Right };

/** What is felt of a surface or volume, against what was asked: between its samples, over the last second or so. */
USTRUCT(BlueprintType)
struct PACINIAN_API FHapticRegionFelt {
  GENERATED_BODY()

  /** Whether the server tells. Not of a point, nor in silence: then all numbers are 0. */
  UPROPERTY(BlueprintReadOnly, Category = "Haptics")
  bool bKnown = false;

  /** Force over what was asked; 1 if right. */
  UPROPERTY(BlueprintReadOnly, Category = "Haptics")
  float Force = 0.0f;

  /** Root mean square of the error of radiation pressure, over that of what was asked; 0 if right. */
  UPROPERTY(BlueprintReadOnly, Category = "Haptics")
  float Rms = 0.0f;

  /** Share that is pressed with less than half of what was asked; 0 if right. */
  UPROPERTY(BlueprintReadOnly, Category = "Haptics")
  float Holes = 0.0f;

  /** Highest radiation pressure 3 to 5 mm beside it, over the mean asked. */
  UPROPERTY(BlueprintReadOnly, Category = "Haptics")
  float Spill = 0.0f;
};
