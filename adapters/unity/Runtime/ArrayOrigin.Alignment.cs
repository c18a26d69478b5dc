using System;
using System.Collections.Generic;
using System.IO;
using UnityEngine;

namespace Pacinian.Haptics
{
    /// <summary>
    /// Alignment: the user touches known points of the array one by one, and the array's pose is computed and stored.
    /// </summary>
    public sealed partial class ArrayOrigin
    {
        private readonly List<Vec3> _touched = new List<Vec3>(); // positions in the parent's frame, without its scale
        private Vector3[] _points = new Vector3[0]; // points to touch

        /// <summary>The number of points that have been touched.</summary>
        public int Touched
        {
            get { return _touched.Count; }
        }

        /// <summary>The root mean square distance between touched and known points after the last alignment [m].</summary>
        public float Residual { get; private set; }

        /// <summary>The largest distance between a touched and a known point after the last alignment [m].</summary>
        public float Worst { get; private set; }

        /// <summary>The file that stores the alignment.</summary>
        internal string Path
        {
            get { return System.IO.Path.Combine(Application.persistentDataPath, "pacinian-" + calibrationName + ".json"); }
        }

        /// <summary>
        /// Discards the touched points and starts again. Returns false if the points are unknown, because no server is
        /// connected.
        /// </summary>
        public bool BeginAlignment()
        {
            CancelAlignment();
            _points = knownPoints.Length > 0 ? knownPoints : Corners(HapticServer.Capabilities);
            return _points.Length > 0;
        }

        /// <summary>Writes the next point to touch, in the array's frame [m]. Returns false if all points have been touched.</summary>
        public bool GetNextPoint(out Vector3 point)
        {
            bool any = _touched.Count < _points.Length;
            point = any ? _points[_touched.Count] : Vector3.zero;
            return any;
        }

        /// <summary>Records where the user touched the next point: a position in the world [m].</summary>
        public void TouchPoint(Vector3 position)
        {
            if (_touched.Count < _points.Length)
            {
                _touched.Add(Parent.Inverse.Point(WireSpace.ToWire(position)));
            }
        }

        /// <summary>
        /// Moves the array to the touched points. Returns false and the reason if fewer than 3 points were touched, or
        /// if all lie on a line.
        /// </summary>
        public bool FinishAlignment(out string problem)
        {
            Vec3[] known = new Vec3[_touched.Count];
            for (int i = 0; i < known.Length; i++)
            {
                known[i] = WireSpace.ToWire(_points[i]);
            }
            Calibration made;
            bool done = Calibration.Fit(known, _touched.ToArray(), out made, out problem);
            if (done)
            {
                Rigid pose = Parent * made.Origin;
                transform.position = WireSpace.ToUnity(pose.Position);
                transform.rotation = WireSpace.ToUnity(pose.Rotation);
                Residual = (float)made.Residual;
                Worst = (float)made.Worst;
                CancelAlignment();
            }
            return done;
        }

        /// <summary>Discards the touched points.</summary>
        public void CancelAlignment()
        {
            _points = new Vector3[0];
            _touched.Clear();
        }

        /// <summary>Stores the pose on this computer. Returns false and the reason if the file cannot be written.</summary>
        public bool SaveCalibration(out string problem)
        {
            problem = StoredPose.Of(transform, Residual, Worst).Save(Path);
            return problem.Length == 0;
        }

        /// <summary>Applies the stored pose. Returns false and the reason if there is none.</summary>
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

        /// <summary>Deletes the stored pose. The array does not move.</summary>
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

        private Rigid Parent
        {
            get { return transform.parent == null ? Rigid.Identity : WireSpace.ToWire(transform.parent); }
        }

        /// <summary>Returns the outermost transducers; none if the array is unknown.</summary>
        private static Vector3[] Corners(Wire.Abilities told)
        {
            if (told == null || told.Positions.Numbers < 9)
            {
                return new Vector3[0];
            }
            Vector3[] corners = new Vector3[4];
            for (int i = 0; i < 4; i++)
            {
                corners[i] = WireSpace.ToUnity(Outermost(told.Positions, i < 2 ? 1.0 : -1.0, i == 0 || i == 3 ? 1.0 : -1.0));
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
