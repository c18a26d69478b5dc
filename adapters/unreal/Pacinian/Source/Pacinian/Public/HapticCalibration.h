#pragma once

#include "CoreMinimal.h"
#include "GameFramework/SaveGame.h"

#include "HapticCalibration.generated.h"

/** The pose of an array as stored on this computer. */
UCLASS()
class PACINIAN_API UHapticCalibration : public USaveGame {
  GENERATED_BODY()

 public:
  /** The pose in the frame of the origin's attach parent [cm]. */
  UPROPERTY()
  FTransform Origin;

  /** Root mean square distance of the alignment [cm]. */
  UPROPERTY()
  double Residual = 0.0;

  UPROPERTY()
  double Worst = 0.0;
};
