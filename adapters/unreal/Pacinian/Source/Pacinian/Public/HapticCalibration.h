#pragma once

#include "CoreMinimal.h"
#include "GameFramework/SaveGame.h"

#include "HapticCalibration.generated.h"

/** Where an array stands, as it is kept on this computer. */
UCLASS()
class PACINIAN_API UHapticCalibration : public USaveGame {
  GENERATED_BODY()

 public:
  /** In what the array's origin is attached to [cm]. */
  UPROPERTY()
  FTransform Origin;

  /** Of the alignment [cm]. */
  UPROPERTY()
  double Residual = 0.0;

  UPROPERTY()
  double Worst = 0.0;
};
