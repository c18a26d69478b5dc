using Pacinian.Wire;
using UnityEngine;

namespace Pacinian.Haptics
{
    /// <summary>Settings of an envelope that may change while it plays. Levels are 0..1.</summary>
    public sealed partial class HapticEnvelope
    {
        /// <summary>The course over time.</summary>
        public EnvelopeKind Kind
        {
            get { return kind; }
            set { kind = value; Changed(); }
        }

        /// <summary>Constant: the level.</summary>
        public float Level
        {
            get { return level; }
            set { level = value; Changed(); }
        }

        /// <summary>Sine and Square: the frequency [Hz].</summary>
        public float Frequency
        {
            get { return frequency; }
            set { frequency = value; Changed(); }
        }

        /// <summary>The lowest level.</summary>
        public float Low
        {
            get { return low; }
            set { low = value; Changed(); }
        }

        /// <summary>The highest level.</summary>
        public float High
        {
            get { return high; }
            set { high = value; Changed(); }
        }

        /// <summary>Square: the fraction of a period with the high level.</summary>
        public float Duty
        {
            get { return duty; }
            set { duty = value; Changed(); }
        }

        /// <summary>Pulse: its length [s].</summary>
        public float Width
        {
            get { return width; }
            set { width = value; Changed(); }
        }

        /// <summary>Pulse: the time after which it repeats [s]; 0: it does not repeat.</summary>
        public float Period
        {
            get { return period; }
            set { period = value; Changed(); }
        }

        /// <summary>Pulse: the time of the first one [s].</summary>
        public float Start
        {
            get { return start; }
            set { start = value; Changed(); }
        }

        /// <summary>Pulse: the time of the rise, and of the fall, within the width [s].</summary>
        public float Rise
        {
            get { return rise; }
            set { rise = value; Changed(); }
        }

        /// <summary>Noise: the lower end of its band [Hz].</summary>
        public float LowFrequency
        {
            get { return lowFrequency; }
            set { lowFrequency = value; Changed(); }
        }

        /// <summary>Noise: the upper end of its band [Hz].</summary>
        public float HighFrequency
        {
            get { return highFrequency; }
            set { highFrequency = value; Changed(); }
        }

        /// <summary>Noise: equal seeds give equal noise.</summary>
        public int Seed
        {
            get { return seed; }
            set { seed = value; Changed(); }
        }

        /// <summary>Preset: its name.</summary>
        public PresetName Preset
        {
            get { return preset; }
            set { preset = value; Changed(); }
        }

        /// <summary>Wave: a clip that replaces samples and rate.</summary>
        public AudioClip Clip
        {
            get { return clip; }
            set { clip = value; Changed(); }
        }

        /// <summary>Wave: samples, -1 to 1, used if there is no clip.</summary>
        public float[] Samples
        {
            get { return samples; }
            set { samples = value ?? new float[0]; Changed(); }
        }

        /// <summary>Wave: the rate of the samples [Hz].</summary>
        public float Rate
        {
            get { return rate; }
            set { rate = value; Changed(); }
        }

        /// <summary>
        /// Curve: the level, 0 to 1, over time [s], from 0 to the last key. Assign the curve again after changing its
        /// keys.
        /// </summary>
        public AnimationCurve Curve
        {
            get { return curve; }
            set { curve = value ?? new AnimationCurve(); Changed(); }
        }

        /// <summary>Wave and Curve: whether it repeats.</summary>
        public bool Loop
        {
            get { return loop; }
            set { loop = value; Changed(); }
        }

        /// <summary>Wave: whether the pressure follows the wave itself, or its loudness.</summary>
        public WaveMode Mode
        {
            get { return mode; }
            set { mode = value; Changed(); }
        }
    }
}
