using System.Collections.Generic;
using UnityEngine;

namespace Pacinian.Haptics
{
    /// <summary>What <see cref="HapticEffect.Strength"/> is measured in.</summary>
    public enum HapticUnit
    {
        /// <summary>Radiation pressure [Pa].</summary>
        Pascal,

        /// <summary>Force, over the whole of it [N].</summary>
        Newton,
    }

    /// <summary>Something to be felt: what points, surfaces and volumes have in common.</summary>
    public abstract partial class HapticEffect : MonoBehaviour
    {
        internal static readonly List<HapticEffect> All = new List<HapticEffect>();

        private static int s_count;

        [SerializeField, Min(0f), Tooltip("Radiation pressure [Pa], or force over the whole of it [N].")]
        private float strength = 8f;
        [SerializeField]
        private HapticUnit unit = HapticUnit.Pascal;
        [SerializeField, Tooltip("How strong it is over time; constant unless given.")]
        private HapticEnvelope envelope;
        [SerializeField]
        private HapticTechnique technique = new HapticTechnique();
        [SerializeField, Min(0f), Tooltip("Pressure for each metre of depth [Pa/m]; 0: the whole is felt 2 mm deep.")]
        private float stiffness;
        [SerializeField, Range(0f, 0.1f), Tooltip("How far outside of it it is felt already [m].")]
        private float reach;
        [SerializeField, Tooltip("Higher ones get samples first.")]
        private int priority;
        [SerializeField, Min(0f), Tooltip("It is over after so long [s]; 0: it stays.")]
        private float duration;
        [SerializeField, Tooltip("Begins when it is enabled; else when Play is called.")]
        private bool playOnEnable = true;
        [SerializeField, Tooltip("Tells how fast it moves, so that the server goes on between two frames.")]
        private bool tellVelocity = true;

        /// <summary>Radiation pressure [Pa] or force [N].</summary>
        public float Strength
        {
            get { return strength; }
            set { strength = value; Changed(); }
        }

        /// <summary>What the strength is measured in.</summary>
        public HapticUnit Unit
        {
            get { return unit; }
            set { unit = value; Changed(); }
        }

        /// <summary>How strong it is over time; null: constant.</summary>
        public HapticEnvelope Envelope
        {
            get { return envelope; }
            set { envelope = value; }
        }

        /// <summary>How its samples are presented in time. Call <see cref="Changed"/> after changing it.</summary>
        public HapticTechnique Technique
        {
            get { return technique; }
            set { technique = value ?? new HapticTechnique(); Changed(); }
        }

        /// <summary>Higher ones get samples first.</summary>
        public int Priority
        {
            get { return priority; }
            set { priority = value; Changed(); }
        }

        /// <summary>It is over after so long [s]; 0: it stays. From the next <see cref="Play"/> on.</summary>
        public float Duration
        {
            get { return duration; }
            set { duration = value; }
        }

        /// <summary>Whether it begins when it is enabled.</summary>
        public bool PlayOnEnable
        {
            get { return playOnEnable; }
            set { playOnEnable = value; }
        }

        /// <summary>Whether it is to be felt now.</summary>
        public bool Playing { get; private set; }

        /// <summary>By which the server knows it, as in `pacinian watch`; "" while disabled.</summary>
        public string WireName
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
            Changed();
        }

        /// <summary>It is felt no more.</summary>
        public void Stop()
        {
            Playing = false;
        }

        /// <summary>Its shape or settings have changed: the server is told with the next frame.</summary>
        public void Changed()
        {
            _changed = true;
        }

        /// <summary>The largest radiation pressure that is emitted for it now [Pa], as the server says; 0 if none is.</summary>
        public float Emitted
        {
            get
            {
                HapticServer server = HapticServer.Current;
                return server == null || server.State == null ? 0f : EmittedGizmos.Most(server.State, _name);
            }
        }

        /// <summary>Its shape, without what all have; null, and why, if it has none.</summary>
        protected abstract Wire.Felt Shaped(out string problem);

        /// <summary>One of the same kind, to be read into.</summary>
        protected abstract Wire.Felt Blank();

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
            string own = gameObject.name;
            _name = (own.Length > 48 ? own.Substring(0, 48) : own) + " " + s_count;
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
            Changed();
        }
    }
}
