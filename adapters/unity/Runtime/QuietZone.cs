using System.Collections.Generic;
using Pacinian.Wire;
using UnityEngine;

namespace Pacinian.Haptics
{
    /// <summary>A sphere around this object that stays quiet. Put it on the camera to protect the user's ears.</summary>
    [AddComponentMenu("Pacinian/Quiet Zone")]
    public sealed class QuietZone : MonoBehaviour
    {
        private const float Lowest = 0.1f, Highest = 1e6f; // [Pa]

        internal static readonly List<QuietZone> All = new List<QuietZone>();

        [SerializeField, Range(0f, 1f), Tooltip("Radius of the sphere [m].")] private float radius = 0.1f;
        [SerializeField, Min(Lowest), Tooltip("Highest sound pressure inside [Pa]; 20 Pa are 120 dB.")]
        private float pressure = 20f;

        /// <summary>The radius of the sphere [m].</summary>
        public float Radius
        {
            get { return radius; }
            set { radius = value; }
        }

        /// <summary>The highest sound pressure inside [Pa]. Less than 0.1 Pa counts as 0.1 Pa.</summary>
        public float Pressure
        {
            get { return pressure; }
            set { pressure = value; }
        }

        /// <summary>Writes the wire's message, in the array's frame. changed: set to true if it differs from before.</summary>
        internal void Write(Rigid toArray, Zone zone, ref bool changed)
        {
            const double Step = 0.002; // [m]; smaller movements are not sent
            Vec3 place = toArray.Point(WireSpace.ToWire(transform.position));
            place = WireSpace.IsInRange(place) ? place : new Vec3(0.0, 0.0, Protocol.MaxCoordinate);
            // What is not a number protects most.
            double wide = radius < 1f ? Mathf.Max(0f, radius) : 1f, most = pressure > Lowest ? Mathf.Min(pressure, Highest) : Lowest;
            if ((place - zone.Position).Length > Step || wide != zone.Radius || most != zone.Pressure)
            {
                zone.Position = place;
                zone.Radius = wide;
                zone.Pressure = most;
                changed = true;
            }
        }

        private void OnEnable()
        {
            All.Add(this);
        }

        private void OnDisable()
        {
            All.Remove(this);
        }

        private void OnDrawGizmosSelected()
        {
            Gizmos.color = new Color(0.3f, 0.6f, 1f);
            Gizmos.DrawWireSphere(transform.position, radius);
        }
    }
}
