using System.Collections.Generic;
using Pacinian.Wire;
using UnityEngine;

namespace Pacinian.Haptics
{
    /// <summary>A tracked hand: from then on only hands feel the scene. One for each.</summary>
    [AddComponentMenu("Pacinian/Haptic Hand")]
    public sealed class HapticHand : MonoBehaviour
    {
        /// <summary>How many joints OpenXR has.</summary>
        public const int Count = 26;

        private const double Longest = 0.1; // [s] between two frames of one movement
        private const double Fastest = 10.0; // [m/s]

        internal static readonly List<HapticHand> All = new List<HapticHand>();

        [SerializeField] private HandFrameSide side = HandFrameSide.Right;
        [SerializeField, Tooltip("Where the joints come from; else the transforms below.")]
        private HandProvider provider;
        [SerializeField, Tooltip("26, in OpenXR's order: palm, wrist, thumb (4), index, middle, ring, little (5 each).")]
        private Transform[] joints = new Transform[0];
        [SerializeField, Tooltip("Tells how fast it moves, so that the server goes on between two frames.")]
        private bool tellVelocity = true;

        private readonly HandFrame _frame = new HandFrame();
        private readonly Vector3[] _positions = new Vector3[Count];
        private readonly float[] _radii = new float[Count];
        private Vec3 _middle;
        private double _time;
        private bool _followed;

        /// <summary>Whether it was tracked in the last frame.</summary>
        public bool Tracked { get; private set; }

        /// <summary>Which it is.</summary>
        public HandFrameSide Side
        {
            get { return side; }
            set { side = value; }
        }

        /// <summary>Where the joints come from; null: from transforms.</summary>
        public HandProvider Provider
        {
            get { return provider; }
            set { provider = value; }
        }

        /// <summary>26 transforms, in OpenXR's order.</summary>
        public Transform[] Joints
        {
            get { return joints; }
            set { joints = value ?? new Transform[0]; }
        }

        /// <summary>The place of a joint in the last frame in which it was tracked, in the world [m].</summary>
        public Vector3 Joint(int index)
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
            if (provider != null)
            {
                return provider.isActiveAndEnabled && provider.TryGet(_positions, _radii) && Finite();
            }
            if (joints.Length != Count)
            {
                return false;
            }
            for (int i = 0; i < Count; i++)
            {
                if (joints[i] == null || !joints[i].gameObject.activeInHierarchy)
                {
                    return false;
                }
                _positions[i] = joints[i].position;
            }
            return Finite();
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
            if (tellVelocity && Tracked && _followed && step > 0.0 && step < Longest)
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
