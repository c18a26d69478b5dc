#pragma once

#include "CoreMinimal.h"

#include "HapticTechnique.generated.h"

/** How an effect's samples are presented in time. */
UENUM(BlueprintType)
enum class EHapticTechnique : uint8 {
  /** As the server is set. */
  Server,
  /** All at once, always. */
  Simultaneous,
  /** Amplitude modulation. */
  AM,
  /** A single focus runs along all of them. */
  STM,
  /** Every sample moves to and fro across its normal. */
  LM,
};

/** A technique and its settings. */
USTRUCT(BlueprintType)
struct PACINIAN_API FHapticTechnique {
  GENERATED_BODY()

  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Haptics")
  EHapticTechnique Kind = EHapticTechnique::Server;

  /** Of AM, STM and LM [Hz]. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Haptics", meta = (ClampMin = "0.1", ClampMax = "20000", Units = "Hz", EditCondition = "Kind >= EHapticTechnique::AM", EditConditionHides))
  float Frequency = 200.0f;

  /** Of AM: 1 goes down to nothing. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Haptics", meta = (ClampMin = "0", ClampMax = "1", EditCondition = "Kind == EHapticTechnique::AM", EditConditionHides))
  float Depth = 1.0f;

  /** Of STM: around all samples, not from one to the next. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Haptics", meta = (EditCondition = "Kind == EHapticTechnique::STM", EditConditionHides))
  bool bOutline = false;

  /** Of LM: to either side [cm]. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Haptics", meta = (ClampMin = "0.01", ClampMax = "2", Units = "cm", EditCondition = "Kind == EHapticTechnique::LM", EditConditionHides))
  float Amplitude = 0.3f;

  /** Of LM: from the array's X towards its Y, about the normal [deg]. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Haptics", meta = (EditCondition = "Kind == EHapticTechnique::LM", EditConditionHides))
  float Angle = 0.0f;
};
