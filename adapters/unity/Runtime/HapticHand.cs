using System.Collections.Generic;
using Pacinian.Wire;
using UnityEngine;

namespace Pacinian.Haptics
{
    /// <summary>A hand, of 26 joints in OpenXR's order. From the first on only hands feel the scene.</summary>
    [AddComponentMenu("Pacinian/Haptic Hand")]
    public sealed partial class HapticHand : MonoBehaviour
    {
        /// <summary>How many joints OpenXR has.</summary>
        public const int Count = 26;

        private const double Longest = 0.1; // [s] between two frames of one movement
        private const double Fastest = 10.0; // [m/s]

        internal static readonly List<HapticHand> All = new List<HapticHand>();

        [SerializeField] private HandFrameSide side = HandFrameSide.Right;
        [SerializeField] private HapticHandSource source = HapticHandSource.Tracker;
        [SerializeField, Tooltip("Of source Tracker; empty: the one beside it.")]
        private HandProvider provider;
        [SerializeField, Tooltip("Tells how it moves, so that it feels where it will be, not where it was.")]
        private bool predictMotion = true;

        private readonly HandFrame _frame = new HandFrame();
        private readonly Vector3[] _positions = new Vector3[Count];
        private readonly float[] _radii = new float[Count];
        private Vec3 _middle;
        private double _time;
        private bool _followed, _given;

        /// <summary>Whether its joints were known in the last frame.</summary>
        public bool Tracked { get; private set; }

        /// <summary>Which it is.</summary>
        public HandFrameSide Side
        {
            get { return side; }
            set { side = value; }
        }

        /// <summary>Where it comes from.</summary>
        public HapticHandSource Source
        {
            get { return source; }
            set { source = value; }
        }

        /// <summary>Of source Tracker; null: the one beside it.</summary>
        public HandProvider Provider
        {
            get { return provider; }
            set { provider = value; }
        }

        /// <summary>Whether it feels where it will be, not where it was.</summary>
        public bool PredictMotion
        {
            get { return predictMotion; }
            set { predictMotion = value; }
        }

        /// <summary>Of source Game: where the 26 joints are, in the world [m]: palm, wrist, thumb from the wrist on, index...</summary>
        public void SetJoints(IList<Vector3> positions)
        {
            _given = positions.Count == Count;
            for (int i = 0; i < Count && _given; i++)
            {
                _positions[i] = positions[i];
            }
        }

        /// <summary>Of source Game: how thick the 26 joints are [m]; none: an adult's.</summary>
        public void SetRadii(IList<float> radii)
        {
            for (int i = 0; i < Count; i++)
            {
                _radii[i] = radii.Count == Count ? radii[i] : 0f;
            }
        }

        /// <summary>Of source Game: it is not tracked any more, and feels nothing.</summary>
        public void SetLost()
        {
            _given = false;
        }

        /// <summary>The place of a joint in the last frame in which it was tracked, in the world [m].</summary>
        internal Vector3 Joint(int index)
        {
            return _positions[index];
        }

        /// <summary>As the wire has it, in the array's frame; without joints where it is not tracked. now: [s].</summary>
        internal HandFrame Frame(Rigid toArray, double now)
        {
            _frame.Side = side;
            _frame.Joints.Clear();
            _frame.Radii.Clear();
            _frame.Velocities.Clear();
            Tracked = Look();
            Vec3 sum = new Vec3();
            for (int i = 0; i < Count && Tracked; i++)
            {
                Vec3 place = toArray.Point(Frames.Of(_positions[i]));
                _frame.Joints.Add(place);
                sum += place;
            }
            WriteRadii();
            WriteVelocity((1.0 / Count) * sum, now);
            return _frame;
        }

        private bool Look()
        {
            switch (source)
            {
                case HapticHandSource.Game: return _given && Finite();
                case HapticHandSource.Open: return Open();
                default:
                    provider = provider == null ? GetComponent<HandProvider>() : provider;
                    return provider != null && provider.isActiveAndEnabled && provider.TryGet(_positions, _radii) && Finite();
            }
        }

        private bool Finite()
        {
            float sum = 0f;
            for (int i = 0; i < Count; i++)
            {
                sum += _positions[i].x + _positions[i].y + _positions[i].z;
            }
            return !float.IsNaN(sum) && !float.IsInfinity(sum);
        }

        private void WriteRadii()
        {
            bool known = Tracked;
            for (int i = 0; i < Count; i++)
            {
                known = known && _radii[i] > 0f && _radii[i] < 0.1f;
            }
            for (int i = 0; i < Count && known; i++)
            {
                _frame.Radii.Add(_radii[i]);
            }
        }

        private void WriteVelocity(Vec3 middle, double now)
        {
            double step = now - _time;
            if (predictMotion && Tracked && _followed && step > 0.0 && step < Longest)
            {
                Vec3 velocity = (1.0 / step) * (middle - _middle);
                if (velocity.Length < Fastest)
                {
                    _frame.Velocities.Add(velocity);
                }
            }
            _middle = middle;
            _time = now;
            _followed = Tracked;
        }

        private void OnEnable()
        {
            _followed = false;
            All.Add(this);
        }

        private void OnDisable()
        {
            All.Remove(this);
            Tracked = false;
        }

        private void OnDrawGizmos()
        {
            Gizmos.color = new Color(0.9f, 0.7f, 0.5f);
            for (int i = 0; i < Count && Tracked; i++)
            {
                Gizmos.DrawWireSphere(_positions[i], _radii[i] > 0f ? _radii[i] : 0.008f);
            }
        }
    }
}
