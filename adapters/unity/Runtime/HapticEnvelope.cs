using System;
using Pacinian.Wire;
using UnityEngine;

namespace Pacinian.Haptics
{
    /// <summary>The course of an envelope.</summary>
    public enum EnvelopeKind
    {
        /// <summary>A constant level.</summary>
        Constant,

        /// <summary>A sine wave.</summary>
        Sine,

        /// <summary>A square wave: high, then low.</summary>
        Square,

        /// <summary>High for a while, otherwise low.</summary>
        Pulse,

        /// <summary>Noise in a band of frequencies.</summary>
        Noise,

        /// <summary>One of the server's textures, by name.</summary>
        Preset,

        /// <summary>A recorded wave.</summary>
        Wave,

        /// <summary>A curve that is drawn by hand.</summary>
        Curve,
    }

    /// <summary>The strength over time: an asset that many effects may share.</summary>
    [CreateAssetMenu(menuName = "Pacinian/Haptic Envelope", fileName = "Envelope")]
    public sealed partial class HapticEnvelope : ScriptableObject
    {
        /// <summary>The constant envelope at full level.</summary>
        internal static readonly IEnvelope Steady = new Constant();

        [SerializeField] private EnvelopeKind kind = EnvelopeKind.Sine;
        [SerializeField, Range(0f, 1f), Tooltip("The level.")] private float level = 1f;
        [SerializeField, Range(0f, 1000f), Tooltip("[Hz]; skin feels 5 to 500 Hz, best about 200 Hz.")] private float frequency = 150f;
        [SerializeField, Range(0f, 1f)] private float low;
        [SerializeField, Range(0f, 1f)] private float high = 1f;
        [SerializeField, Range(0f, 1f), Tooltip("Fraction of a period with the high level.")] private float duty = 0.5f;
        [SerializeField, Min(0.001f), Tooltip("Length of a pulse [s].")] private float width = 0.05f;
        [SerializeField, Min(0f), Tooltip("Time after which it repeats [s]; 0: never.")] private float period;
        [SerializeField, Tooltip("Time of the first pulse [s].")] private float start;
        [SerializeField, Min(0f), Tooltip("Time of the rise, and of the fall, within the width [s].")] private float rise;
        [SerializeField, Range(0f, 1000f), Tooltip("[Hz]")] private float lowFrequency = 50f;
        [SerializeField, Range(1f, 1000f), Tooltip("[Hz]")] private float highFrequency = 250f;
        [SerializeField, Min(0), Tooltip("Equal seeds give equal noise.")] private int seed;
        [SerializeField] private PresetName preset = PresetName.Impulsive;
        [SerializeField, Tooltip("Replaces samples and rate.")] private AudioClip clip;
        [SerializeField, Tooltip("A recorded wave, -1 to 1.")] private float[] samples = new float[0];
        [SerializeField, Min(1f), Tooltip("Rate of the samples [Hz].")] private float rate = 1000f;
        [SerializeField, Tooltip("Repeat.")] private bool loop = true;
        [SerializeField, Tooltip("Whether the pressure follows the wave itself, or its loudness.")]
        private WaveMode mode = WaveMode.Waveform;
        [SerializeField, Tooltip("Level, 0 to 1, over time [s], from 0 to the last key.")]
        private AnimationCurve curve = AnimationCurve.Linear(0f, 1f, 1f, 0f);

        [NonSerialized] private IEnvelope _message;

        /// <summary>The number of changes.</summary>
        internal int Version { get; private set; }

        /// <summary>Why the envelope is not as intended; "" if it is.</summary>
        public string Problem { get; private set; } = "";

        /// <summary>The wire's message; the same object until the envelope changes.</summary>
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
