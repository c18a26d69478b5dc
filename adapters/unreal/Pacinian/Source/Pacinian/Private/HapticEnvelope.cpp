#include "HapticEnvelope.h"

#include "Curves/CurveFloat.h"
#include "Envelopes.h"

THIRD_PARTY_INCLUDES_START
#include "pacinian/wire/protocol.h"
THIRD_PARTY_INCLUDES_END

namespace wire = pacinian::wire;

namespace Haptic {

namespace {

wire::Pulse Pulse(const UHapticEnvelope& Given) {
  wire::Pulse Made;
  Made.width = Given.Width;
  if (Given.Period > 0.0f) Made.period = Given.Period;
  Made.start = Given.Start;
  Made.rise = Given.Rise;
  Made.low = Given.Low;
  Made.high = Given.High;
  return Made;
}

wire::Noise Noise(const UHapticEnvelope& Given) {
  wire::Noise Made;
  Made.low_frequency = Given.LowFrequency;
  Made.high_frequency = Given.HighFrequency;
  Made.low = Given.Low;
  Made.high = Given.High;
  Made.seed = Given.Seed;
  return Made;
}

constexpr int32 Fast = 8000;  // [Hz]; skin feels nothing above 1 kHz

/// Returns how many samples are averaged to one.
int32 Group(const UHapticEnvelope& Given) { return FMath::Max(1, static_cast<int32>(Given.Rate) / Fast); }

int32 Groups(const UHapticEnvelope& Given) { return FMath::Max(1, Given.Samples.Num() / Group(Given)); }

wire::Wave Wave(const UHapticEnvelope& Given) {
  wire::Wave Made;
  const int32 Each = Group(Given), Count = FMath::Min(Groups(Given), static_cast<int32>(wire::MAX_VALUES));
  for (int32 i = 0; i < Count; ++i) {
    const int32 End = FMath::Min((i + 1) * Each, Given.Samples.Num());
    float Sum = 0.0f;
    for (int32 j = i * Each; j < End; ++j) Sum += Given.Samples[j];
    wire::append(Made.samples, FMath::Clamp(Sum / static_cast<float>(End - i * Each), -1.0f, 1.0f));
  }
  Made.rate = FMath::Clamp(Given.Rate, 1.0f, 1e6f) / static_cast<double>(Each);
  Made.loop = Given.bLoop;
  Made.mode = Given.Mode == EHapticWave::Loudness ? wire::WaveMode::loudness : wire::WaveMode::waveform;
  return Made;
}

constexpr double Fine = 2000.0;  // [Hz]; lower if the curve is long

/// Returns the time of a curve's last key [s]; 0 if there is none.
float Length(const UCurveFloat* Curve) {
  float First = 0.0f, Last = 0.0f;
  if (Curve) Curve->GetTimeRange(First, Last);
  return FMath::Max(Last, 0.0f);
}

wire::Wave Drawn(const UHapticEnvelope& Given, double Seconds) {
  wire::Wave Made;
  Made.rate = FMath::Max(1.0, FMath::Min(Fine, wire::MAX_VALUES / Seconds));
  const int32 Count = FMath::Max(1, FMath::Min(FMath::RoundToInt32(Seconds * Made.rate), static_cast<int32>(wire::MAX_VALUES)));
  for (int32 i = 0; i < Count; ++i) {
    const float Level = FMath::Clamp(Given.Curve->GetFloatValue(static_cast<float>(i / Made.rate)), 0.0f, 1.0f);
    wire::append(Made.samples, 2.0f * Level - 1.0f);
  }
  Made.loop = Given.bLoop;
  Made.mode = wire::WaveMode::waveform;
  return Made;
}

}  // namespace

wire::Envelope ToWire(const UHapticEnvelope* Envelope) {
  if (!Envelope) return wire::Constant{};
  const UHapticEnvelope& Given = *Envelope;
  switch (Given.Kind) {
    case EHapticEnvelope::Sine:
      return wire::Sine{Given.Frequency, Given.Low, Given.High};
    case EHapticEnvelope::Square:
      return wire::Square{Given.Frequency, Given.Low, Given.High, Given.Duty};
    case EHapticEnvelope::Pulse:
      return Pulse(Given);
    case EHapticEnvelope::Noise:
      return Noise(Given);
    case EHapticEnvelope::Preset:
      return static_cast<wire::PresetName>(Given.Preset);
    case EHapticEnvelope::Wave:
      if (Given.Samples.Num() > 0) return Wave(Given);
      break;
    case EHapticEnvelope::Curve:
      if (const float Seconds = Length(Given.Curve); Seconds > 0.0f) return Drawn(Given, Seconds);
      break;
    case EHapticEnvelope::Constant:
      break;
  }
  return wire::Constant{Given.Level};
}

}  // namespace Haptic

FString UHapticEnvelope::GetProblem() const {
  if (Kind == EHapticEnvelope::Curve && Haptic::Length(Curve) <= 0.0f) return FString(TEXT("its curve has no key after 0 s"));
  if (Kind != EHapticEnvelope::Wave) return FString();
  if (Samples.Num() == 0) return FString(TEXT("has no samples"));
  const int32 Most = static_cast<int32>(wire::MAX_VALUES);
  if (Haptic::Groups(*this) <= Most) return FString();
  return FString::Printf(TEXT("its wave is cut after %d s"), static_cast<int32>(Most * Haptic::Group(*this) / Rate));
}

static_assert(static_cast<int>(wire::PresetName::impulsive) == static_cast<int>(EHapticPreset::Impulsive));
static_assert(static_cast<int>(wire::PresetName::rapturous) == static_cast<int>(EHapticPreset::Rapturous));
static_assert(static_cast<int>(wire::PresetName::trembling) == static_cast<int>(EHapticPreset::Trembling));
static_assert(static_cast<int>(wire::PresetName::buzzing) == static_cast<int>(EHapticPreset::Buzzing));
