using UnityEngine;

namespace Pacinian.Haptics
{
    /// <summary>Unity's numbers (left-handed, y up, metres) and those of the wire (right-handed, z up, metres).</summary>
    internal static class Frames
    {
        /// <summary>A place, direction or velocity.</summary>
        public static Vec3 Of(Vector3 v)
        {
            return UnitySpace.Swap(new Vec3(v.x, v.y, v.z));
        }

        /// <summary>A rotation, of length one.</summary>
        public static Quat Of(Quaternion q)
        {
            return UnitySpace.Swap(new Quat(q.x, q.y, q.z, q.w)).Normalised;
        }

        /// <summary>Where a transform is in the world; its scale is left out.</summary>
        public static Rigid Of(Transform transform)
        {
            return new Rigid(Of(transform.position), Of(transform.rotation));
        }

        /// <summary>A place, direction or velocity in Unity.</summary>
        public static Vector3 Back(Vec3 v)
        {
            Vec3 u = UnitySpace.Swap(v);
            return new Vector3((float)u.X, (float)u.Y, (float)u.Z);
        }

        /// <summary>A rotation in Unity.</summary>
        public static Quaternion Back(Quat q)
        {
            Quat u = UnitySpace.Swap(q);
            return new Quaternion((float)u.X, (float)u.Y, (float)u.Z, (float)u.W);
        }

        /// <summary>Whether the wire takes a place: finite, at most 10 m along each axis.</summary>
        public static bool InReach(Vec3 v)
        {
            const double Farthest = 10.0;
            return System.Math.Abs(v.X) <= Farthest && System.Math.Abs(v.Y) <= Farthest && System.Math.Abs(v.Z) <= Farthest;
        }
    }
}
