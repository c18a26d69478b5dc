using System;
using Pacinian.Wire;
using UnityEngine;

namespace Pacinian.Haptics
{
    /// <summary>The course of an envelope.</summary>
    public enum EnvelopeKind
    {
        /// <summary>The same at all times.</summary>
        Constant,

        /// <summary>Up and down.</summary>
        Sine,

        /// <summary>High, then low.</summary>
        Square,

        /// <summary>High for a while, else low.</summary>
        Pulse,

        /// <summary>Random, in a band of frequencies.</summary>
        Noise,

        /// <summary>A texture of the server's, by name.</summary>
        Preset,

        /// <summary>A recorded wave.</summary>
        Wave,

        /// <summary>As a curve has it, which is drawn by hand.</summary>
        Curve,
    }

    /// <summary>How strong something is over time: an asset that many effects may share.</summary>
    [CreateAssetMenu(menuName = "Pacinian/Haptic Envelope", fileName = "Envelope")]
    public sealed partial class HapticEnvelope : ScriptableObject
    {
        /// <summary>The same at all times.</summary>
        internal static readonly IEnvelope Steady = new Constant();

        [SerializeField] private EnvelopeKind kind = EnvelopeKind.Sine;
        [SerializeField, Range(0f, 1f), Tooltip("How strong, always.")] private float level = 1f;
        [SerializeField, Range(0f, 1000f), Tooltip("[Hz]; skin feels 5 to 500 Hz, best about 200 Hz.")] private float frequency = 150f;
        [SerializeField, Range(0f, 1f)] private float low;
        [SerializeField, Range(0f, 1f)] private float high = 1f;
        [SerializeField, Range(0f, 1f), Tooltip("Share of a period that is high.")] private float duty = 0.5f;
        [SerializeField, Min(0.001f), Tooltip("How long a pulse is [s].")] private float width = 0.05f;
        [SerializeField, Min(0f), Tooltip("After which it comes again [s]; 0: only once.")] private float period;
        [SerializeField, Tooltip("When it first comes [s].")] private float start;
        [SerializeField, Min(0f), Tooltip("How long it takes up, and again down, within the width [s].")] private float rise;
        [SerializeField, Range(0f, 1000f), Tooltip("[Hz]")] private float lowFrequency = 50f;
        [SerializeField, Range(1f, 1000f), Tooltip("[Hz]")] private float highFrequency = 250f;
        [SerializeField, Min(0), Tooltip("The same is the same noise.")] private int seed;
        [SerializeField] private PresetName preset = PresetName.Impulsive;
        [SerializeField, Tooltip("In place of samples and rate.")] private AudioClip clip;
        [SerializeField, Tooltip("A recorded wave, -1 to 1.")] private float[] samples = new float[0];
        [SerializeField, Min(1f), Tooltip("Of these samples [Hz].")] private float rate = 1000f;
        [SerializeField, Tooltip("Again and again, else once.")] private bool loop = true;
        [SerializeField, Tooltip("Whether the pressure follows the wave itself, or how loud it is.")]
        private WaveMode mode = WaveMode.Waveform;
        [SerializeField, Tooltip("Strength, 0 to 1, over time [s], from 0 to its last key.")]
        private AnimationCurve curve = AnimationCurve.Linear(0f, 1f, 1f, 0f);

        [NonSerialized] private IEnvelope _message;

        /// <summary>Counts its changes.</summary>
        internal int Version { get; private set; }

        /// <summary>Why it is not as it was meant; "" if it is.</summary>
        public string Problem { get; private set; } = "";

        /// <summary>As the wire has it; the same object until it changes.</summary>
        internal IEnvelope Message
        {
            get { return _message ?? (_message = Made()); }
        }

        private void OnValidate()
        {
            Changed();
        }

        private void Changed()
        {
            _message = null;
            Version++;
        }

        private IEnvelope Made()
        {
            string problem;
            Problem = "";
            double bottom = Mathf.Clamp01(low), top = Mathf.Clamp01(high), often = Mathf.Clamp(frequency, 0f, 20000f);
            switch (kind)
            {
                case EnvelopeKind.Sine: return new Sine { Frequency = often, Low = bottom, High = top };
                case EnvelopeKind.Square:
                    return new Square { Frequency = often, Low = bottom, High = top, Duty = Mathf.Clamp01(duty) };
                case EnvelopeKind.Pulse: return Pulsed(bottom, top);
                case EnvelopeKind.Noise:
                    return new Noise
                    {
                        LowFrequency = Mathf.Clamp(lowFrequency, 0f, 20000f), High = top, Low = bottom,
                        HighFrequency = Mathf.Clamp(Math.Max(lowFrequency + 1f, highFrequency), 1f, 20000f), Seed = seed,
                    };
                case EnvelopeKind.Preset: return new Wire.Preset { Name = preset };
                case EnvelopeKind.Wave:
                    Wave wave = clip == null
                        ? AudioWave.Of(samples, Mathf.Clamp(rate, 1f, 1e6f), 1, out problem)
                        : AudioWave.Of(clip, out problem);
                    Problem = problem;
                    return Played(wave, mode) ?? Steady;
                case EnvelopeKind.Curve:
                    Wave drawn = CurveWave.Of(curve, out problem);
                    Problem = problem;
                    return Played(drawn, WaveMode.Waveform) ?? Steady;
                default: return new Constant { Level = Mathf.Clamp01(level) };
            }
        }

        private IEnvelope Played(Wave wave, WaveMode how)
        {
            if (wave != null)
            {
                wave.Loop = loop;
                wave.Mode = how;
            }
            return wave;
        }

        private Pulse Pulsed(double bottom, double top)
        {
            double wide = Mathf.Max(width, 1e-4f);
            return new Pulse
            {
                Width = wide, Start = start, Period = period > 0f ? (double?)Math.Max(period, wide) : null,
                Rise = Math.Min(Mathf.Max(rise, 0f), 0.5 * wide), Low = bottom, High = top,
            };
        }
    }
}
