using System.Collections.Generic;
using UnityEngine;

namespace Pacinian.Haptics
{
    /// <summary>The unit in which an effect's strength is given.</summary>
    public enum HapticStrength
    {
        /// <summary>The same radiation pressure everywhere.</summary>
        RadiationPressure,

        /// <summary>A force over the whole effect.</summary>
        Force,
    }

    /// <summary>Something that hands can feel: the common base of points, surfaces and volumes.</summary>
    public abstract partial class HapticEffect : MonoBehaviour
    {
        internal static readonly List<HapticEffect> All = new List<HapticEffect>();

        private static int s_count;

        [SerializeField, Tooltip("Name on the server, at most 64 characters; empty: derived from the object's name. Further effects "
            + "of one name get a number, as in \"ball 2\".")]
        private string effectName = "";
        [SerializeField, Tooltip("Whether the effect has a radiation pressure or a force.")]
        private HapticStrength strength = HapticStrength.RadiationPressure;
        [SerializeField, Min(0f), Tooltip("Pressure on touched skin [Pa].")]
        private float radiationPressure = 8f;
        [SerializeField, Min(0f), Tooltip("Force of the whole effect [N].")]
        private float force = 0.005f;
        [SerializeField, Tooltip("Strength over time; empty: constant.")]
        private HapticEnvelope envelope;
        [SerializeField]
        private HapticTechnique technique = new HapticTechnique();
        [SerializeField, Min(0f), Tooltip("The effect ends after this time [s]; 0: it plays until it is stopped.")]
        private float duration;
        [SerializeField, Tooltip("Effects with a higher priority come first if the array cannot render all.")]
        private int priority;
        [SerializeField, Min(0f), Tooltip("Pressure per metre of depth [Pa/m]; 0: full pressure at a depth of 2 mm.")]
        private float stiffness;
        [SerializeField, Range(0f, 10f), Tooltip("Distance outside the shape from which it is felt [m].")]
        private float reach;
        [SerializeField, Tooltip("Play when enabled. Otherwise, call Play.")]
        private bool playOnEnable = true;
        [SerializeField, Tooltip("Send the motion, so that the effect is felt where it will be instead of where it was.")]
        private bool predictMotion = true;

        /// <summary>The duration is over.</summary>
        public event System.Action Finished;

        /// <summary>Whether the effect is to be felt now.</summary>
        public bool Playing { get; private set; }

        /// <summary>The name on the server, as in `pacinian watch`; "" while disabled.</summary>
        internal string WireName
        {
            get { return _name; }
        }

        /// <summary>Why the effect cannot be felt, and what to do; "" if it can.</summary>
        public string Problem { get; private set; } = "";

        /// <summary>Starts the effect, or restarts it.</summary>
        public void Play()
        {
            Playing = isActiveAndEnabled;
            _begin = Time.realtimeSinceStartupAsDouble;
            Refresh();
        }

        /// <summary>Stops the effect: it is no longer felt.</summary>
        public void Stop()
        {
            Playing = false;
        }

        /// <summary>Sends the effect again with the next frame, because its shape or settings have changed.</summary>
        public void Refresh()
        {
            _changed = true;
            _drawn = false;
        }

        /// <summary>The largest radiation pressure emitted for the effect, as the server reports it [Pa]; 0 if there is none.</summary>
        public float Emitted
        {
            get { return EmittedState.Most(EmittedState.Now, _name); }
        }

        /// <summary>The achieved and the requested pressure of the effect, as the server reports them; unknown for a point.</summary>
        public RegionFelt RegionFelt
        {
            get { return Pacinian.RegionFelt.Of(EmittedState.Now, _name); }
        }

        /// <summary>The pose of the shape in the world, in the wire's axes and without scale.</summary>
        internal virtual Rigid ShapePose
        {
            get { return WireSpace.ToWire(transform); }
        }

        /// <summary>Returns the shape without the settings that all effects have; null and the reason if there is none.</summary>
        protected internal abstract Wire.HapticObject Describe(out string problem);

        /// <summary>Writes the pose, in the array's frame.</summary>
        protected abstract void Place(Wire.HapticObject felt, Rigid pose);

        /// <summary>Returns whether the shape differs from the one that was sent.</summary>
        protected virtual bool Reshaped()
        {
            return false;
        }

        /// <summary>Registers the effect.</summary>
        protected virtual void OnEnable()
        {
            s_count = s_count == int.MaxValue ? 1 : s_count + 1;
            string own = effectName.Length > 0 ? Cut(effectName, 64) : Cut(gameObject.name, 48) + " " + s_count;
            _name = own;
            for (int i = 2; Named(_name) is object; i++)
            {
                _name = Cut(own, 58) + " " + i;
            }
            _known = _there = 0;
            _tracker.Forget();
            All.Add(this);
            if (playOnEnable)
            {
                Play();
            }
        }

        /// <summary>Removes the effect.</summary>
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

        /// <summary>Returns the beginning of a text, without half a character.</summary>
        private static string Cut(string text, int longest)
        {
            return text.Length <= longest ? text : text.Substring(0, char.IsHighSurrogate(text[longest - 1]) ? longest - 1 : longest);
        }

        /// <summary>Sends the effect again after a change in the inspector.</summary>
        protected virtual void OnValidate()
        {
            Refresh();
        }
    }
}
