#pragma once

#include "CoreMinimal.h"

#include "HapticTechnique.generated.h"

/** How an effect's samples are presented in time. */
UENUM(BlueprintType)
enum class EHapticTechnique : uint8 {
  /** The server's default. */
  Server,
  /** All samples at the same time. */
  Simultaneous,
  /** Amplitude modulation. */
  AM,
  /** Spatiotemporal modulation: one focus visits all samples. */
  STM,
  /** Lateral modulation: every sample moves to and fro across its normal. */
  LM,
};

/** A technique and its settings. */
USTRUCT(BlueprintType)
struct PACINIAN_API FHapticTechnique {
  GENERATED_BODY()

  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Haptics")
  EHapticTechnique Kind = EHapticTechnique::Server;

  /** AM, STM and LM: the frequency [Hz]. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Haptics", meta = (ClampMin = "0.1", ClampMax = "20000", Units = "Hz", EditCondition = "Kind == EHapticTechnique::AM || Kind == EHapticTechnique::STM || Kind == EHapticTechnique::LM", EditConditionHides))
  float Frequency = 200.0f;

  /** AM: the depth; 1 goes down to silence. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Haptics", meta = (ClampMin = "0", ClampMax = "1", EditCondition = "Kind == EHapticTechnique::AM", EditConditionHides))
  float Depth = 1.0f;

  /** STM: the focus runs around all samples instead of from one to the next. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Haptics", meta = (EditCondition = "Kind == EHapticTechnique::STM", EditConditionHides))
  bool bOutline = false;

  /** LM: the amplitude to either side [cm]. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Haptics", meta = (ClampMin = "0.01", ClampMax = "2", Units = "cm", EditCondition = "Kind == EHapticTechnique::LM", EditConditionHides))
  float Amplitude = 0.3f;

  /** LM: the direction, from the array's X towards its Y, about the normal [deg]. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Haptics", meta = (EditCondition = "Kind == EHapticTechnique::LM", EditConditionHides))
  float Angle = 0.0f;
};
