using System.Collections.Generic;
using Pacinian.Wire;
using UnityEngine;

namespace Pacinian.Haptics
{
    /// <summary>
    /// A hand of 26 joints in OpenXR's order. As soon as there is a hand, objects are felt only where hands touch them. At
    /// most 8 hands count. Touches name a hand by its side, and further hands of that side "right 2", "right 3"...
    /// </summary>
    [AddComponentMenu("Pacinian/Haptic Hand")]
    public sealed partial class HapticHand : MonoBehaviour
    {
        /// <summary>The number of OpenXR's joints.</summary>
        public const int Count = 26;

        private const double MaxStepTime = 0.1; // [s] longest time between two frames of one movement
        private const double MaxSpeed = 10.0; // [m/s]

        internal static readonly List<HapticHand> All = new List<HapticHand>();

        [SerializeField] private HandFrameSide side = HandFrameSide.Right;
        [SerializeField] private HapticHandSource source = HapticHandSource.Tracker;
        [SerializeField, Tooltip("Source Tracker: the provider; empty: the one on this object.")]
        private HandProvider provider;
        [SerializeField, Tooltip("Source Mouse: how far the hand is from this object when the mouse is at the window's edge [m].")]
        private float mouseReach = 0.15f;
        [SerializeField, Tooltip("Send the motion, so that the hand feels where it will be instead of where it was.")]
        private bool predictMotion = true;

        private readonly HandFrame _frame = new HandFrame();
        private readonly Vector3[] _positions = new Vector3[Count];
        private readonly float[] _radii = new float[Count];
        private Vec3 _middle;
        private double _time;
        private bool _followed, _given;

        /// <summary>Whether the joints were known in the last frame.</summary>
        public bool Tracked { get; private set; }

        /// <summary>Left or right.</summary>
        public HandFrameSide Side
        {
            get { return side; }
            set { side = value; }
        }

        /// <summary>The source of the hand's joints.</summary>
        public HapticHandSource Source
        {
            get { return source; }
            set { source = value; }
        }

        /// <summary>Source Tracker: the provider; null: the one on this object.</summary>
        public HandProvider Provider
        {
            get { return provider; }
            set { provider = value; }
        }

        /// <summary>Whether the hand's motion is sent, so that it feels where it will be instead of where it was.</summary>
        public bool PredictMotion
        {
            get { return predictMotion; }
            set { predictMotion = value; }
        }

        /// <summary>
        /// Source Game: sets the positions of the 26 joints in the world [m]: palm, wrist, thumb from its metacarpal
        /// on, index...
        /// </summary>
        public void SetJoints(IList<Vector3> positions)
        {
            _given = positions.Count == Count;
            for (int i = 0; i < Count && _given; i++)
            {
                _positions[i] = positions[i];
            }
        }

        /// <summary>Source Game: sets the radii of the 26 joints [m]; an empty list: an adult's.</summary>
        public void SetRadii(IList<float> radii)
        {
            for (int i = 0; i < Count; i++)
            {
                _radii[i] = radii.Count == Count ? radii[i] : 0f;
            }
        }

        /// <summary>Source Game: reports that the hand is no longer tracked. It then feels nothing.</summary>
        public void SetLost()
        {
            _given = false;
        }

        /// <summary>Returns the position of a joint in the last tracked frame, in the world [m].</summary>
        internal Vector3 Joint(int index)
        {
            return _positions[index];
        }

        /// <summary>Returns the wire's message, in the array's frame; without joints if the hand is not tracked. now: [s].</summary>
        internal HandFrame Frame(Rigid toArray, double now)
        {
            _frame.Side = side;
            _frame.Name = MakeName();
            _frame.Joints.Clear();
            _frame.Radii.Clear();
            _frame.Velocities.Clear();
            Tracked = Look();
            Vec3 sum = new Vec3();
            for (int i = 0; i < Count && Tracked; i++)
            {
                Vec3 place = toArray.Point(WireSpace.ToWire(_positions[i]));
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
                case HapticHandSource.Open: return Open(Vector3.zero);
                case HapticHandSource.Mouse: return FollowMouse();
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
            if (predictMotion && Tracked && _followed && step > 0.0 && step < MaxStepTime)
            {
                Vec3 velocity = (1.0 / step) * (middle - _middle);
                if (velocity.Length < MaxSpeed)
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
            _frame.Name = "";
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
