using System;
using Pacinian.Wire;
using UnityEngine;

namespace Pacinian.Haptics
{
    /// <summary>The course of an envelope.</summary>
    public enum EnvelopeKind
    {
        /// <summary>The same at all times: high.</summary>
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
    }

    /// <summary>How strong something is over time: an asset that many effects may share.</summary>
    [CreateAssetMenu(menuName = "Pacinian/Haptic Envelope", fileName = "Envelope")]
    public sealed class HapticEnvelope : ScriptableObject
    {
        /// <summary>The same at all times.</summary>
        internal static readonly IEnvelope Steady = new Constant();

        [SerializeField] private EnvelopeKind kind = EnvelopeKind.Sine;
        [SerializeField, Range(0f, 1f)] private float low;
        [SerializeField, Range(0f, 1f)] private float high = 1f;
        [SerializeField, Range(0f, 1000f), Tooltip("[Hz]")] private float frequency = 150f;
        [SerializeField, Range(0f, 1f), Tooltip("Share of a period that is high.")] private float duty = 0.5f;
        [SerializeField, Min(0.0001f), Tooltip("How long it is high [s].")] private float width = 0.05f;
        [SerializeField, Min(0f), Tooltip("After which it comes again [s]; 0: only once.")] private float period;
        [SerializeField, Min(0f), Tooltip("How long it takes up, and again down, within the width [s].")] private float rise;
        [SerializeField, Range(0f, 1000f), Tooltip("[Hz]")] private float lowFrequency = 20f;
        [SerializeField, Range(1f, 1000f), Tooltip("[Hz]")] private float highFrequency = 250f;
        [SerializeField, Min(0)] private int seed;
        [SerializeField] private PresetName preset = PresetName.Trembling;
        [SerializeField] private AudioClip clip;
        [SerializeField, Tooltip("Again and again, else once.")] private bool loop = true;
        [SerializeField, Tooltip("Follows how loud the clip is, not its waveform.")] private bool loudness;

        [NonSerialized] private IEnvelope _message;

        /// <summary>Counts its changes.</summary>
        internal int Version { get; private set; }

        /// <summary>Why it is not as it was meant; "" if it is.</summary>
        public string Problem { get; private set; } = "";

        /// <summary>Its course.</summary>
        public EnvelopeKind Kind
        {
            get { return kind; }
            set { kind = value; Changed(); }
        }

        /// <summary>Of sine and square [Hz].</summary>
        public float Frequency
        {
            get { return frequency; }
            set { frequency = value; Changed(); }
        }

        /// <summary>How weak and strong it is, 0..1.</summary>
        public float Low
        {
            get { return low; }
            set { low = value; Changed(); }
        }

        /// <inheritdoc cref="Low"/>
        public float High
        {
            get { return high; }
            set { high = value; Changed(); }
        }

        /// <summary>Of kind Wave.</summary>
        public AudioClip Clip
        {
            get { return clip; }
            set { clip = value; Changed(); }
        }

        /// <summary>Of kind Preset.</summary>
        public PresetName Preset
        {
            get { return preset; }
            set { preset = value; Changed(); }
        }

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
                    string problem;
                    IEnvelope wave = AudioWave.Of(clip, loop, loudness, out problem);
                    Problem = problem;
                    return wave ?? Steady;
                default: return new Constant { Level = top };
            }
        }

        private Pulse Pulsed(double bottom, double top)
        {
            double wide = Mathf.Max(width, 1e-4f);
            return new Pulse
            {
                Width = wide, Period = period > 0f ? (double?)Math.Max(period, wide) : null,
                Rise = Math.Min(Mathf.Max(rise, 0f), 0.5 * wide), Low = bottom, High = top,
            };
        }
    }
}
