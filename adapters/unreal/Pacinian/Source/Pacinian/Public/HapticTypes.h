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
  /** Nobody has armed it, or there is nothing to feel. */
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
