#pragma once

#include "CoreMinimal.h"

#include "HapticTypes.generated.h"

/** The state of the connection to the server. */
UENUM(BlueprintType)
enum class EHapticStatus : uint8 {
  /** Not connected, and not connecting. */
  Stopped,
  /** No server is connected; the component tries again and again. */
  Connecting,
  Connected,
  /** The server rejects the client until something is changed: see Get Problem. */
  Refused,
};

/** The state of the output, as the server reports it. */
UENUM(BlueprintType)
enum class EHapticOutput : uint8 {
  /** No server has reported it. */
  Unknown,
  /** Silent: no client has armed the output, or there is nothing to feel. */
  Silent,
  /** Sounding: something can be felt. */
  Sounding,
  /** Silent until the renderer, which is late, continues. */
  Stale,
  /** Silent after an emergency stop, until Reset Output. */
  Stopped,
  /** Silent after a failure of a plug-in or device, until Reset Output. */
  Faulted,
};

/** The unit in which an effect's strength is given. */
UENUM(BlueprintType)
enum class EHapticStrength : uint8 {
  /** The same radiation pressure everywhere. */
  RadiationPressure,
  /** A force over the whole effect. */
  Force,
};

/** The side of a hand. */
UENUM(BlueprintType)
enum class EHapticSide : uint8 { Left, Right };

/** The achieved pressure of a surface or volume, compared with the requested one, over about the last second: on all
 * touched skin or, in free air, between the samples. */
USTRUCT(BlueprintType)
struct PACINIAN_API FHapticRegionFelt {
  GENERATED_BODY()

  /** Whether the server reports the numbers. It does not for a point, nor in silence: then all numbers are 0. */
  UPROPERTY(BlueprintReadOnly, Category = "Haptics")
  bool bKnown = false;

  /** Achieved force divided by the requested one; 1 is ideal. */
  UPROPERTY(BlueprintReadOnly, Category = "Haptics")
  float Force = 0.0f;

  /** Root mean square error of the radiation pressure, relative to that of the requested one; 0 is ideal. */
  UPROPERTY(BlueprintReadOnly, Category = "Haptics")
  float Rms = 0.0f;

  /** The fraction of the region with less than half of the requested pressure; 0 is ideal. */
  UPROPERTY(BlueprintReadOnly, Category = "Haptics")
  float Holes = 0.0f;

  /** The highest radiation pressure beside the region (3 to 30 mm on skin, 3 to 5 mm in free air), relative to the mean
   * requested one. */
  UPROPERTY(BlueprintReadOnly, Category = "Haptics")
  float Spill = 0.0f;
};
