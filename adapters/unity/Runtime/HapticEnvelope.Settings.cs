using Pacinian.Wire;
using UnityEngine;

namespace Pacinian.Haptics
{
    /// <summary>What can be set of an envelope while it plays. Levels are 0..1.</summary>
    public sealed partial class HapticEnvelope
    {
        /// <summary>Its course.</summary>
        public EnvelopeKind Kind
        {
            get { return kind; }
            set { kind = value; Changed(); }
        }

        /// <summary>Of kind Constant: how strong, always.</summary>
        public float Level
        {
            get { return level; }
            set { level = value; Changed(); }
        }

        /// <summary>Of Sine and Square [Hz].</summary>
        public float Frequency
        {
            get { return frequency; }
            set { frequency = value; Changed(); }
        }

        /// <summary>How weak it is, at its lowest.</summary>
        public float Low
        {
            get { return low; }
            set { low = value; Changed(); }
        }

        /// <summary>How strong it is, at its highest.</summary>
        public float High
        {
            get { return high; }
            set { high = value; Changed(); }
        }

        /// <summary>Of Square: the share of a period that is high.</summary>
        public float Duty
        {
            get { return duty; }
            set { duty = value; Changed(); }
        }

        /// <summary>Of Pulse: how long it is [s].</summary>
        public float Width
        {
            get { return width; }
            set { width = value; Changed(); }
        }

        /// <summary>Of Pulse: after how long it comes again [s]; 0: only once.</summary>
        public float Period
        {
            get { return period; }
            set { period = value; Changed(); }
        }

        /// <summary>Of Pulse: when it first comes [s].</summary>
        public float Start
        {
            get { return start; }
            set { start = value; Changed(); }
        }

        /// <summary>Of Pulse: how long it takes up, and again down, within its width [s].</summary>
        public float Rise
        {
            get { return rise; }
            set { rise = value; Changed(); }
        }

        /// <summary>Of Noise: its lower end [Hz].</summary>
        public float LowFrequency
        {
            get { return lowFrequency; }
            set { lowFrequency = value; Changed(); }
        }

        /// <summary>Of Noise: its upper end [Hz].</summary>
        public float HighFrequency
        {
            get { return highFrequency; }
            set { highFrequency = value; Changed(); }
        }

        /// <summary>Of Noise: the same is the same noise.</summary>
        public int Seed
        {
            get { return seed; }
            set { seed = value; Changed(); }
        }

        /// <summary>Of kind Preset.</summary>
        public PresetName Preset
        {
            get { return preset; }
            set { preset = value; Changed(); }
        }

        /// <summary>Of Wave, in place of samples and rate.</summary>
        public AudioClip Clip
        {
            get { return clip; }
            set { clip = value; Changed(); }
        }

        /// <summary>Of Wave: -1 to 1, where there is no clip.</summary>
        public float[] Samples
        {
            get { return samples; }
            set { samples = value ?? new float[0]; Changed(); }
        }

        /// <summary>Of these samples [Hz].</summary>
        public float Rate
        {
            get { return rate; }
            set { rate = value; Changed(); }
        }

        /// <summary>Of Curve: strength, 0 to 1, over time [s], from 0 to its last key. Set it again after changing its keys.</summary>
        public AnimationCurve Curve
        {
            get { return curve; }
            set { curve = value ?? new AnimationCurve(); Changed(); }
        }

        /// <summary>Of Wave and Curve: again and again, or once.</summary>
        public bool Loop
        {
            get { return loop; }
            set { loop = value; Changed(); }
        }

        /// <summary>Of Wave: whether the pressure follows the wave itself, or how loud it is.</summary>
        public WaveMode Mode
        {
            get { return mode; }
            set { mode = value; Changed(); }
        }
    }
}
