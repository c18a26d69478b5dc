#pragma once

#include "CoreMinimal.h"
#include "Engine/DataAsset.h"

#include "HapticEnvelope.generated.h"

class UCurveFloat;

/** The course of an envelope. */
UENUM(BlueprintType)
enum class EHapticEnvelope : uint8 { Constant, Sine, Square, Pulse, Noise, Preset, Wave, Curve };

/** Textures by Hasegawa and Shinoda. */
UENUM(BlueprintType)
enum class EHapticPreset : uint8 { Impulsive, Rapturous, Trembling, Buzzing };

/** How a recorded wave sets the pressure. */
UENUM(BlueprintType)
enum class EHapticWave : uint8 {
  /** The pressure follows the wave itself. */
  Waveform,
  /** The pressure follows the loudness of the wave. */
  Loudness,
};

/** The strength over time: an asset that effects can share. Levels are 0 to 1. */
UCLASS(BlueprintType)
class PACINIAN_API UHapticEnvelope : public UDataAsset {
  GENERATED_BODY()

 public:
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Envelope")
  EHapticEnvelope Kind = EHapticEnvelope::Sine;

  /** The level. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Envelope", meta = (ClampMin = "0", ClampMax = "1", EditCondition = "Kind == EHapticEnvelope::Constant", EditConditionHides))
  float Level = 1.0f;

  /** Frequency [Hz]. Skin feels 5 to 500 Hz, best about 200 Hz. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Envelope", meta = (ClampMin = "0", ClampMax = "20000", Units = "Hz", EditCondition = "Kind == EHapticEnvelope::Sine || Kind == EHapticEnvelope::Square", EditConditionHides))
  float Frequency = 150.0f;

  /** The lowest level. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Envelope", meta = (ClampMin = "0", ClampMax = "1", EditCondition = "Kind == EHapticEnvelope::Sine || Kind == EHapticEnvelope::Square || Kind == EHapticEnvelope::Pulse || Kind == EHapticEnvelope::Noise", EditConditionHides))
  float Low = 0.0f;

  /** The highest level. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Envelope", meta = (ClampMin = "0", ClampMax = "1", EditCondition = "Kind == EHapticEnvelope::Sine || Kind == EHapticEnvelope::Square || Kind == EHapticEnvelope::Pulse || Kind == EHapticEnvelope::Noise", EditConditionHides))
  float High = 1.0f;

  /** Fraction of a period with the high level. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Envelope", meta = (ClampMin = "0", ClampMax = "1", EditCondition = "Kind == EHapticEnvelope::Square", EditConditionHides))
  float Duty = 0.5f;

  /** Length of a pulse [s]. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Envelope", meta = (ClampMin = "0.001", Units = "s", EditCondition = "Kind == EHapticEnvelope::Pulse", EditConditionHides))
  float Width = 0.05f;

  /** Time after which the pulse repeats [s]. 0: never. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Envelope", meta = (ClampMin = "0", Units = "s", EditCondition = "Kind == EHapticEnvelope::Pulse", EditConditionHides))
  float Period = 0.0f;

  /** Time of the first pulse [s]. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Envelope", meta = (Units = "s", EditCondition = "Kind == EHapticEnvelope::Pulse", EditConditionHides))
  float Start = 0.0f;

  /** Time of the rise, and of the fall, within the width [s]. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Envelope", meta = (ClampMin = "0", Units = "s", EditCondition = "Kind == EHapticEnvelope::Pulse", EditConditionHides))
  float Rise = 0.0f;

  /** Lower end of the noise's band [Hz]. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Envelope", meta = (ClampMin = "0", ClampMax = "20000", Units = "Hz", EditCondition = "Kind == EHapticEnvelope::Noise", EditConditionHides))
  float LowFrequency = 50.0f;

  /** Upper end of the noise's band [Hz]. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Envelope", meta = (ClampMin = "0.001", ClampMax = "20000", Units = "Hz", EditCondition = "Kind == EHapticEnvelope::Noise", EditConditionHides))
  float HighFrequency = 250.0f;

  /** Equal seeds give equal noise. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Envelope", meta = (ClampMin = "0", EditCondition = "Kind == EHapticEnvelope::Noise", EditConditionHides))
  int32 Seed = 0;

  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Envelope", meta = (EditCondition = "Kind == EHapticEnvelope::Preset", EditConditionHides))
  EHapticPreset Preset = EHapticPreset::Impulsive;

  /** Samples of the wave, -1 to 1. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Envelope", meta = (EditCondition = "Kind == EHapticEnvelope::Wave", EditConditionHides))
  TArray<float> Samples;

  /** Rate of the samples [Hz]. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Envelope", meta = (ClampMin = "1", Units = "Hz", EditCondition = "Kind == EHapticEnvelope::Wave", EditConditionHides))
  float Rate = 1000.0f;

  /** Level, 0 to 1, over time [s], from 0 to the last key. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Envelope", meta = (EditCondition = "Kind == EHapticEnvelope::Curve", EditConditionHides))
  TObjectPtr<UCurveFloat> Curve;

  /** Repeats the wave or curve. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Envelope", meta = (EditCondition = "Kind == EHapticEnvelope::Wave || Kind == EHapticEnvelope::Curve", EditConditionHides))
  bool bLoop = true;

  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Envelope", meta = (EditCondition = "Kind == EHapticEnvelope::Wave", EditConditionHides))
  EHapticWave Mode = EHapticWave::Waveform;

  /** Returns why the envelope is not as intended; empty if it is. */
  UFUNCTION(BlueprintPure, Category = "Envelope")
  FString GetProblem() const;
};
