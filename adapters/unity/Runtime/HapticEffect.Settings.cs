using UnityEngine;

namespace Pacinian.Haptics
{
    /// <summary>Settings of an effect that may change while it plays.</summary>
    public abstract partial class HapticEffect
    {
        /// <summary>
        /// The name of the effect on the server, at most 64 characters; "": derived from the object's name. Set it
        /// before enabling the effect.
        /// </summary>
        public string EffectName
        {
            get { return effectName; }
            set { effectName = value ?? ""; }
        }

        /// <summary>Whether the effect has a radiation pressure or a force.</summary>
        public HapticStrength Strength
        {
            get { return strength; }
            set { strength = value; Refresh(); }
        }

        /// <summary>The pressure on touched skin [Pa]. Setting it switches <see cref="Strength"/> to RadiationPressure.</summary>
        public float RadiationPressure
        {
            get { return radiationPressure; }
            set { radiationPressure = value; Strength = HapticStrength.RadiationPressure; }
        }

        /// <summary>The radiation pressure relative to the full pressure in Project Settings > Pacinian, 0..1.</summary>
        public float RelativeStrength
        {
            get { return Mathf.Clamp01(radiationPressure / PacinianSettings.Current.FullPressure); }
            set { RadiationPressure = Mathf.Clamp01(value) * PacinianSettings.Current.FullPressure; }
        }

        /// <summary>The force of the whole effect [N]. Setting it switches <see cref="Strength"/> to Force.</summary>
        public float Force
        {
            get { return force; }
            set { force = value; Strength = HapticStrength.Force; }
        }

        /// <summary>The strength over time; null: constant.</summary>
        public HapticEnvelope Envelope
        {
            get { return envelope; }
            set { envelope = value; }
        }

        /// <summary>How the samples are presented in time. Call <see cref="Refresh"/> after changing it.</summary>
        public HapticTechnique Technique
        {
            get { return technique; }
            set { technique = value ?? new HapticTechnique(); Refresh(); }
        }

        /// <summary>
        /// The effect ends after this time [s]; 0: it plays until <see cref="Stop"/>. Set it before <see cref="Play"/>.
        /// </summary>
        public float Duration
        {
            get { return duration; }
            set { duration = value; }
        }

        /// <summary>Effects with a higher priority come first if the array cannot render all.</summary>
        public int Priority
        {
            get { return priority; }
            set { priority = value; Refresh(); }
        }

        /// <summary>The pressure per metre of depth [Pa/m]; 0: the full pressure is reached at a depth of 2 mm.</summary>
        public float Stiffness
        {
            get { return stiffness; }
            set { stiffness = value; Refresh(); }
        }

        /// <summary>The distance outside the shape from which it is felt [m].</summary>
        public float Reach
        {
            get { return reach; }
            set { reach = value; Refresh(); }
        }

        /// <summary>Whether the effect plays when it is enabled.</summary>
        public bool PlayOnEnable
        {
            get { return playOnEnable; }
            set { playOnEnable = value; }
        }

        /// <summary>Whether the effect's motion is sent, so that it is felt where it will be instead of where it was.</summary>
        public bool PredictMotion
        {
            get { return predictMotion; }
            set { predictMotion = value; }
        }
    }
}
