#include "HapticEnvelope.h"

#include "Envelopes.h"

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

wire::Wave Wave(const UHapticEnvelope& Given) {
  wire::Wave Made;
  for (const float Sample : Given.Samples) wire::append(Made.samples, FMath::Clamp(Sample, -1.0f, 1.0f));
  Made.rate = Given.Rate;
  Made.loop = Given.bLoop;
  Made.mode = Given.Mode == EHapticWave::Loudness ? wire::WaveMode::loudness : wire::WaveMode::waveform;
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
    case EHapticEnvelope::Constant:
      break;
  }
  return wire::Constant{Given.Level};
}

}  // namespace Haptic

static_assert(static_cast<int>(wire::PresetName::impulsive) == static_cast<int>(EHapticPreset::Impulsive));
static_assert(static_cast<int>(wire::PresetName::rapturous) == static_cast<int>(EHapticPreset::Rapturous));
static_assert(static_cast<int>(wire::PresetName::trembling) == static_cast<int>(EHapticPreset::Trembling));
static_assert(static_cast<int>(wire::PresetName::buzzing) == static_cast<int>(EHapticPreset::Buzzing));
