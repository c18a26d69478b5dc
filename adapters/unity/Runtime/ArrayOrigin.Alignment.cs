using System;
using System.Collections.Generic;
using System.IO;
using UnityEngine;

namespace Pacinian.Haptics
{
    /// <summary>Where the array stands is found by touching known points of it, one by one, and kept.</summary>
    public sealed partial class ArrayOrigin
    {
        private readonly List<Vec3> _touched = new List<Vec3>(); // in the parent's frame
        private Vector3[] _points = new Vector3[0]; // to be touched

        /// <summary>How many points have been touched.</summary>
        public int Touched
        {
            get { return _touched.Count; }
        }

        /// <summary>Root mean square distance of touched from known points after the last alignment [m].</summary>
        public float Residual { get; private set; }

        /// <summary>The largest of these distances [m].</summary>
        public float Worst { get; private set; }

        /// <summary>Where the alignment is kept.</summary>
        internal string Path
        {
            get { return System.IO.Path.Combine(Application.persistentDataPath, "pacinian-" + calibrationName + ".json"); }
        }

        /// <summary>Forgets what was touched, and begins anew. False: the points are not known, as no server is connected.</summary>
        public bool BeginAlignment()
        {
            CancelAlignment();
            _points = knownPoints.Length > 0 ? knownPoints : Corners(HapticServer.Capabilities);
            return _points.Length > 0;
        }

        /// <summary>The point of the array to be touched next, in its frame [m]. False: all have been.</summary>
        public bool GetNextPoint(out Vector3 point)
        {
            bool any = _touched.Count < _points.Length;
            point = any ? _points[_touched.Count] : Vector3.zero;
            return any;
        }

        /// <summary>The next point was touched there, in the world [m].</summary>
        public void TouchPoint(Vector3 position)
        {
            if (_touched.Count < _points.Length)
            {
                Transform space = transform.parent;
                _touched.Add(Frames.Of(space == null ? position : space.InverseTransformPoint(position)));
            }
        }

        /// <summary>Moves to where the array is. False, and why: fewer than 3 points, or all in a line.</summary>
        public bool FinishAlignment(out string problem)
        {
            Vec3[] known = new Vec3[_touched.Count];
            for (int i = 0; i < known.Length; i++)
            {
                known[i] = Frames.Of(_points[i]);
            }
            Calibration made;
            bool done = Calibration.Fit(known, _touched.ToArray(), out made, out problem);
            if (done)
            {
                transform.localPosition = Frames.Back(made.Origin.Position);
                transform.localRotation = Frames.Back(made.Origin.Rotation);
                Residual = (float)made.Residual;
                Worst = (float)made.Worst;
                CancelAlignment();
            }
            return done;
        }

        /// <summary>Forgets what was touched.</summary>
        public void CancelAlignment()
        {
            _points = new Vector3[0];
            _touched.Clear();
        }

        /// <summary>Keeps the pose on this computer. False, and why: it cannot be written.</summary>
        public bool SaveCalibration(out string problem)
        {
            problem = StoredPose.Of(transform, Residual, Worst).Save(Path);
            return problem.Length == 0;
        }

        /// <summary>Takes over the pose that was kept. False, and why: there is none.</summary>
        public bool LoadCalibration(out string problem)
        {
            StoredPose pose = StoredPose.Load(Path, out problem);
            if (pose != null)
            {
                transform.localPosition = pose.Position;
                transform.localRotation = pose.Rotation;
                Residual = pose.residual;
                Worst = pose.worst;
            }
            return pose != null;
        }

        /// <summary>Removes what was kept; the pose stays.</summary>
        public void ForgetCalibration()
        {
            try
            {
                File.Delete(Path);
            }
            catch (Exception error) when (error is IOException || error is UnauthorizedAccessException)
            {
                Debug.LogWarning("Pacinian: " + error.Message, this);
            }
        }

        /// <summary>The outermost transducers; none where nothing is known of the array.</summary>
        private static Vector3[] Corners(Wire.Abilities told)
        {
            if (told == null || told.Positions.Numbers < 9)
            {
                return new Vector3[0];
            }
            Vector3[] corners = new Vector3[4];
            for (int i = 0; i < 4; i++)
            {
                corners[i] = Frames.Back(Outermost(told.Positions, i < 2 ? 1.0 : -1.0, i == 0 || i == 3 ? 1.0 : -1.0));
            }
            return corners;
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
    }
}
