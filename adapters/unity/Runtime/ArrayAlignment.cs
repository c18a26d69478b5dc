using System.Collections.Generic;
using UnityEngine;

namespace Pacinian.Haptics
{
    /// <summary>Finds where the array stands: a tracked finger or controller touches known points of it, one by one.</summary>
    [RequireComponent(typeof(ArrayOrigin))]
    [AddComponentMenu("Pacinian/Array Alignment")]
    public sealed class ArrayAlignment : MonoBehaviour
    {
        [SerializeField, Tooltip("3 or more, in the order in which they are touched: from the array's middle, y up [m].")]
        private Vector3[] knownPoints =
        {
            new Vector3(-0.285f, 0f, -0.23f), new Vector3(0.285f, 0f, -0.23f), new Vector3(0.285f, 0f, 0.23f),
        };
        [SerializeField, Tooltip("What touches: the tip of a tracked finger, or of a controller.")]
        private Transform pointer;

        private readonly List<Vec3> _touched = new List<Vec3>();

        /// <summary>In the order in which they are touched, in the array's frame [m].</summary>
        public Vector3[] KnownPoints
        {
            get { return knownPoints; }
            set { knownPoints = value ?? new Vector3[0]; Begin(); }
        }

        /// <summary>What touches.</summary>
        public Transform Pointer
        {
            get { return pointer; }
            set { pointer = value; }
        }

        /// <summary>How many have been touched.</summary>
        public int Touched
        {
            get { return _touched.Count; }
        }

        /// <summary>Why it could not be aligned, and what to do; "" if nothing is wrong.</summary>
        public string Problem { get; private set; } = "";

        /// <summary>Root mean square, and largest distance of the known from the touched points [m].</summary>
        public float Residual { get; private set; }

        /// <inheritdoc cref="Residual"/>
        public float Worst { get; private set; }

        /// <summary>From the first point again.</summary>
        public void Begin()
        {
            _touched.Clear();
            Problem = "";
        }

        /// <summary>The pointer touches the next point now. True: it was the last, and the array is aligned and stored.</summary>
        public bool Touch()
        {
            Problem = pointer == null ? "no pointer is given" : "";
            return pointer != null && Touch(pointer.position);
        }

        /// <summary>The next point is there, in the world.</summary>
        public bool Touch(Vector3 place)
        {
            Transform space = transform.parent;
            _touched.Add(Frames.Of(space == null ? place : space.InverseTransformPoint(place)));
            return _touched.Count >= knownPoints.Length && Align();
        }

        /// <summary>The outermost transducers, as the server tells of its array, are the points. False: it has not told.</summary>
        public bool UseCorners()
        {
            HapticServer server = HapticServer.Current;
            Wire.Abilities told = server == null ? null : server.Capabilities;
            if (told == null || told.Positions.Numbers < 9)
            {
                return false;
            }
            Vector3[] corners = new Vector3[4];
            for (int i = 0; i < 4; i++)
            {
                corners[i] = Frames.Back(Outermost(told.Positions, i == 1 || i == 2 ? 1.0 : -1.0, i >= 2 ? 1.0 : -1.0));
            }
            KnownPoints = corners;
            return true;
        }

        private static Vec3 Outermost(Wire.Bulk points, double x, double y)
        {
            Vec3 best = points.Point(0);
            for (int i = 1; i < points.Numbers / 3; i++)
            {
                Vec3 point = points.Point(i);
                best = x * point.X + y * point.Y > x * best.X + y * best.Y ? point : best;
            }
            return best;
        }

        private bool Align()
        {
            Vec3[] known = new Vec3[knownPoints.Length];
            for (int i = 0; i < known.Length; i++)
            {
                known[i] = Frames.Of(knownPoints[i]);
            }
            Calibration made;
            string problem;
            bool done = Calibration.Fit(known, _touched.ToArray(), out made, out problem);
            Begin();
            Problem = problem;
            if (done)
            {
                transform.localPosition = Frames.Back(made.Origin.Position);
                transform.localRotation = Frames.Back(made.Origin.Rotation);
                Residual = (float)made.Residual;
                Worst = (float)made.Worst;
                ArrayOrigin origin = GetComponent<ArrayOrigin>();
                origin.Residual = Residual;
                Problem = origin.Save();
            }
            return done;
        }

        private void OnDrawGizmosSelected()
        {
            for (int i = 0; i < knownPoints.Length; i++)
            {
                Gizmos.color = i < _touched.Count ? Color.green : Color.yellow;
                Gizmos.DrawSphere(transform.position + transform.rotation * knownPoints[i], 0.006f);
            }
        }
    }
}
