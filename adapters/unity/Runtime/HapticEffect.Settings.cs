using UnityEngine;

namespace Pacinian.Haptics
{
    /// <summary>What can be set of an effect while it plays.</summary>
    public abstract partial class HapticEffect
    {
        /// <summary>By which the server knows it, at most 64 characters; "": made of the object's name. Before this is enabled.</summary>
        public string EffectName
        {
            get { return effectName; }
            set { effectName = value ?? ""; }
        }

        /// <summary>Whether it has a radiation pressure or a force.</summary>
        public HapticStrength Strength
        {
            get { return strength; }
            set { strength = value; Refresh(); }
        }

        /// <summary>How hard it presses where it is touched [Pa]; setting it makes it the strength.</summary>
        public float RadiationPressure
        {
            get { return radiationPressure; }
            set { radiationPressure = value; Strength = HapticStrength.RadiationPressure; }
        }

        /// <summary>The radiation pressure, from 0 to 1: its share of the full one in Project Settings > Pacinian.</summary>
        public float RelativeStrength
        {
            get { return Mathf.Clamp01(radiationPressure / PacinianSettings.Current.FullPressure); }
            set { RadiationPressure = Mathf.Clamp01(value) * PacinianSettings.Current.FullPressure; }
        }

        /// <summary>How hard it presses altogether [N]; setting it makes it the strength.</summary>
        public float Force
        {
            get { return force; }
            set { force = value; Strength = HapticStrength.Force; }
        }

        /// <summary>How strong it is over time; null: constant.</summary>
        public HapticEnvelope Envelope
        {
            get { return envelope; }
            set { envelope = value; }
        }

        /// <summary>How its samples are presented in time. Call <see cref="Refresh"/> after changing it.</summary>
        public HapticTechnique Technique
        {
            get { return technique; }
            set { technique = value ?? new HapticTechnique(); Refresh(); }
        }

        /// <summary>It is over after so long [s]; 0: it stays. From the next <see cref="Play"/> on.</summary>
        public float Duration
        {
            get { return duration; }
            set { duration = value; }
        }

        /// <summary>Higher ones come first where the array cannot do all.</summary>
        public int Priority
        {
            get { return priority; }
            set { priority = value; Refresh(); }
        }

        /// <summary>Pressure for each metre of depth [Pa/m]; 0: the whole is felt 2 mm deep.</summary>
        public float Stiffness
        {
            get { return stiffness; }
            set { stiffness = value; Refresh(); }
        }

        /// <summary>How far outside of it it is felt already [m].</summary>
        public float Reach
        {
            get { return reach; }
            set { reach = value; Refresh(); }
        }

        /// <summary>Whether it begins when it is enabled.</summary>
        public bool PlayOnEnable
        {
            get { return playOnEnable; }
            set { playOnEnable = value; }
        }

        /// <summary>Whether it is felt where it will be, not where it was.</summary>
        public bool PredictMotion
        {
            get { return predictMotion; }
            set { predictMotion = value; }
        }
    }
}
