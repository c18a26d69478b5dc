#pragma once

#include "CoreMinimal.h"
#include "Engine/DataAsset.h"

#include "HapticEnvelope.generated.h"

class UCurveFloat;

/** How an effect's strength changes with time. */
UENUM(BlueprintType)
enum class EHapticEnvelope : uint8 { Constant, Sine, Square, Pulse, Noise, Preset, Wave, Curve };

/** Textures of Hasegawa and Shinoda. */
UENUM(BlueprintType)
enum class EHapticPreset : uint8 { Impulsive, Rapturous, Trembling, Buzzing };

/** How a recorded wave is felt. */
UENUM(BlueprintType)
enum class EHapticWave : uint8 {
  /** The pressure follows the wave itself. */
  Waveform,
  /** The pressure follows how loud the wave is. */
  Loudness,
};

/** How strong an effect is over time; an asset that effects share. Levels are 0 to 1. */
UCLASS(BlueprintType)
class PACINIAN_API UHapticEnvelope : public UDataAsset {
  GENERATED_BODY()

 public:
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Envelope")
  EHapticEnvelope Kind = EHapticEnvelope::Sine;

  /** How strong, always. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Envelope", meta = (ClampMin = "0", ClampMax = "1", EditCondition = "Kind == EHapticEnvelope::Constant", EditConditionHides))
  float Level = 1.0f;

  /** How often it goes up and down [Hz]. The skin feels 5 to 500 Hz, best about 200 Hz. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Envelope", meta = (ClampMin = "0", ClampMax = "20000", Units = "Hz", EditCondition = "Kind == EHapticEnvelope::Sine || Kind == EHapticEnvelope::Square", EditConditionHides))
  float Frequency = 150.0f;

  /** At its lowest. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Envelope", meta = (ClampMin = "0", ClampMax = "1", EditCondition = "Kind >= EHapticEnvelope::Sine && Kind <= EHapticEnvelope::Noise", EditConditionHides))
  float Low = 0.0f;

  /** At its highest. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Envelope", meta = (ClampMin = "0", ClampMax = "1", EditCondition = "Kind >= EHapticEnvelope::Sine && Kind <= EHapticEnvelope::Noise", EditConditionHides))
  float High = 1.0f;

  /** Share of a period that is high. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Envelope", meta = (ClampMin = "0", ClampMax = "1", EditCondition = "Kind == EHapticEnvelope::Square", EditConditionHides))
  float Duty = 0.5f;

  /** How long a pulse is [s]. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Envelope", meta = (ClampMin = "0.001", Units = "s", EditCondition = "Kind == EHapticEnvelope::Pulse", EditConditionHides))
  float Width = 0.05f;

  /** After how long the pulse comes again [s]. 0: only once. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Envelope", meta = (ClampMin = "0", Units = "s", EditCondition = "Kind == EHapticEnvelope::Pulse", EditConditionHides))
  float Period = 0.0f;

  /** When the pulse first comes [s]. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Envelope", meta = (Units = "s", EditCondition = "Kind == EHapticEnvelope::Pulse", EditConditionHides))
  float Start = 0.0f;

  /** How long it takes to come, and again to go, within its width [s]. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Envelope", meta = (ClampMin = "0", Units = "s", EditCondition = "Kind == EHapticEnvelope::Pulse", EditConditionHides))
  float Rise = 0.0f;

  /** Lower end of the noise [Hz]. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Envelope", meta = (ClampMin = "0", ClampMax = "20000", Units = "Hz", EditCondition = "Kind == EHapticEnvelope::Noise", EditConditionHides))
  float LowFrequency = 50.0f;

  /** Upper end of the noise [Hz]. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Envelope", meta = (ClampMin = "0.001", ClampMax = "20000", Units = "Hz", EditCondition = "Kind == EHapticEnvelope::Noise", EditConditionHides))
  float HighFrequency = 250.0f;

  /** The same is the same noise. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Envelope", meta = (ClampMin = "0", EditCondition = "Kind == EHapticEnvelope::Noise", EditConditionHides))
  int32 Seed = 0;

  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Envelope", meta = (EditCondition = "Kind == EHapticEnvelope::Preset", EditConditionHides))
  EHapticPreset Preset = EHapticPreset::Impulsive;

  /** The recorded wave, -1 to 1. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Envelope", meta = (EditCondition = "Kind == EHapticEnvelope::Wave", EditConditionHides))
  TArray<float> Samples;

  /** Of these samples [Hz]. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Envelope", meta = (ClampMin = "1", Units = "Hz", EditCondition = "Kind == EHapticEnvelope::Wave", EditConditionHides))
  float Rate = 1000.0f;

  /** Strength, 0 to 1, over time [s], from 0 to its last key. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Envelope", meta = (EditCondition = "Kind == EHapticEnvelope::Curve", EditConditionHides))
  TObjectPtr<UCurveFloat> Curve;

  /** Again and again, or once. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Envelope", meta = (EditCondition = "Kind == EHapticEnvelope::Wave || Kind == EHapticEnvelope::Curve", EditConditionHides))
  bool bLoop = true;

  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Envelope", meta = (EditCondition = "Kind == EHapticEnvelope::Wave", EditConditionHides))
  EHapticWave Mode = EHapticWave::Waveform;

  /** Why it is not as it was meant. Empty if it is. */
  UFUNCTION(BlueprintPure, Category = "Envelope")
  FString GetProblem() const;
};
