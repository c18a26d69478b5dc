using System.Collections.Generic;
using Pacinian.Wire;
using UnityEngine;

namespace Pacinian.Haptics
{
    /// <summary>A ball that is to stay quiet, around this object: put it on the camera, for the user's ears.</summary>
    [AddComponentMenu("Pacinian/Quiet Zone")]
    public sealed class QuietZone : MonoBehaviour
    {
        internal static readonly List<QuietZone> All = new List<QuietZone>();

        [SerializeField, Range(0f, 1f), Tooltip("Of the ball [m].")] private float radius = 0.1f;
        [SerializeField, Min(0f), Tooltip("The most sound pressure in it [Pa]; 20 Pa are 120 dB.")] private float pressure = 20f;

        /// <summary>Of the ball [m].</summary>
        public float Radius
        {
            get { return radius; }
            set { radius = value; }
        }

        /// <summary>The most sound pressure in it [Pa].</summary>
        public float Pressure
        {
            get { return pressure; }
            set { pressure = value; }
        }

        /// <summary>As the wire has it, in the array's frame. changed: set if it is another than it was.</summary>
        internal void Write(Rigid toArray, Zone zone, ref bool changed)
        {
            const double Step = 0.002; // [m] that it may move before it is told again
            const double Farthest = 10.0;
            Vec3 place = toArray.Point(Frames.Of(transform.position));
            place = Frames.InReach(place) ? place : new Vec3(0.0, 0.0, Farthest);
            double wide = Mathf.Clamp01(radius), most = Mathf.Clamp(pressure, 0f, 1e6f);
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
