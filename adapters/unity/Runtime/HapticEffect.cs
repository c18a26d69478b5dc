using System.Collections.Generic;
using UnityEngine;

namespace Pacinian.Haptics
{
    /// <summary>What is given of an effect's strength.</summary>
    public enum HapticStrength
    {
        /// <summary>Radiation pressure, everywhere the same.</summary>
        RadiationPressure,

        /// <summary>A force, over the whole of it.</summary>
        Force,
    }

    /// <summary>Something to be felt: what points, surfaces and volumes have in common.</summary>
    public abstract partial class HapticEffect : MonoBehaviour
    {
        internal static readonly List<HapticEffect> All = new List<HapticEffect>();

        private static int s_count;

        [SerializeField, Tooltip("By which the server knows it, at most 64 characters; empty: made of the object's name.")]
        private string effectName = "";
        [SerializeField, Tooltip("Whether it has a radiation pressure or a force.")]
        private HapticStrength strength = HapticStrength.RadiationPressure;
        [SerializeField, Min(0f), Tooltip("How hard it presses where it is touched [Pa].")]
        private float radiationPressure = 8f;
        [SerializeField, Min(0f), Tooltip("How hard it presses altogether [N].")]
        private float force = 0.005f;
        [SerializeField, Tooltip("How strong it is over time; constant unless given.")]
        private HapticEnvelope envelope;
        [SerializeField]
        private HapticTechnique technique = new HapticTechnique();
        [SerializeField, Min(0f), Tooltip("It is over after so long [s]; 0: it stays.")]
        private float duration;
        [SerializeField, Tooltip("Higher ones come first where the array cannot do all.")]
        private int priority;
        [SerializeField, Min(0f), Tooltip("Pressure for each metre of depth [Pa/m]; 0: the whole is felt 2 mm deep.")]
        private float stiffness;
        [SerializeField, Range(0f, 10f), Tooltip("How far outside of it it is felt already [m].")]
        private float reach;
        [SerializeField, Tooltip("Begins when it is enabled; else when Play is called.")]
        private bool playOnEnable = true;
        [SerializeField, Tooltip("Tells how it moves, so that it is felt where it will be, not where it was.")]
        private bool predictMotion = true;

        /// <summary>Its duration is over.</summary>
        public event System.Action Finished;

        /// <summary>Whether it is to be felt now.</summary>
        public bool Playing { get; private set; }

        /// <summary>By which the server knows it, as in `pacinian watch`; "" while disabled.</summary>
        internal string WireName
        {
            get { return _name; }
        }

        /// <summary>Why it cannot be felt, and what to do; "" if it can.</summary>
        public string Problem { get; private set; } = "";

        /// <summary>Begins, or begins anew.</summary>
        public void Play()
        {
            Playing = isActiveAndEnabled;
            _begin = Time.realtimeSinceStartupAsDouble;
            Refresh();
        }

        /// <summary>It is felt no more.</summary>
        public void Stop()
        {
            Playing = false;
        }

        /// <summary>Its shape or settings have changed: the server is told with the next frame.</summary>
        public void Refresh()
        {
            _changed = true;
            _drawn = false;
        }

        /// <summary>The largest radiation pressure that is emitted for it now [Pa], as the server says; 0 if none is.</summary>
        public float Emitted
        {
            get { return Haptics.Emitted.Most(Haptics.Emitted.Now, _name); }
        }

        /// <summary>What is felt of it, against what was asked, as the server says; not known of a point.</summary>
        public RegionFelt RegionFelt
        {
            get { return Pacinian.RegionFelt.Of(Haptics.Emitted.Now, _name); }
        }

        /// <summary>Its shape, without what all have; null, and why, if it has none.</summary>
        protected internal abstract Wire.Felt Shaped(out string problem);

        /// <summary>Where it is, in the array's frame.</summary>
        protected abstract void Place(Wire.Felt felt, Rigid pose);

        /// <summary>Whether its shape is another than when it was put.</summary>
        protected virtual bool Reshaped()
        {
            return false;
        }

        /// <summary>Takes part from now on.</summary>
        protected virtual void OnEnable()
        {
            s_count = s_count == int.MaxValue ? 1 : s_count + 1;
            string own = effectName.Length > 0 ? effectName : gameObject.name;
            int longest = effectName.Length > 0 ? 64 : 48;
            own = own.Length > longest ? own.Substring(0, longest) : own;
            _name = effectName.Length > 0 ? own : own + " " + s_count;
            _known = _there = 0;
            _velocity.Forget();
            All.Add(this);
            if (playOnEnable)
            {
                Play();
            }
        }

        /// <summary>It is felt no more.</summary>
        protected virtual void OnDisable()
        {
            All.Remove(this);
            HapticServer server = HapticServer.Current;
            if (server != null && server.Client != null)
            {
                Withdraw(server.Client);
            }
            Playing = false;
            _name = "";
        }

        /// <summary>It was changed in the inspector.</summary>
        protected virtual void OnValidate()
        {
            Refresh();
        }
    }
}
