using Pacinian.Wire;
using UnityEngine;

namespace Pacinian.Haptics
{
    /// <summary>Converts between Unity's axes (left-handed, y up, metres) and the wire's (right-handed, z up, metres).</summary>
    internal static class WireSpace
    {
        /// <summary>Converts a position, direction or velocity to the wire's axes.</summary>
        public static Vec3 ToWire(Vector3 v)
        {
            return UnitySpace.Swap(new Vec3(v.x, v.y, v.z));
        }

        /// <summary>Converts a rotation to the wire's axes, and normalises it.</summary>
        public static Quat ToWire(Quaternion q)
        {
            return UnitySpace.Swap(new Quat(q.x, q.y, q.z, q.w)).Normalised;
        }

        /// <summary>Returns the pose of a transform in the world, in the wire's axes and without scale.</summary>
        public static Rigid ToWire(Transform transform)
        {
            return new Rigid(ToWire(transform.position), ToWire(transform.rotation));
        }

        /// <summary>Converts a position, direction or velocity to Unity's axes.</summary>
        public static Vector3 ToUnity(Vec3 v)
        {
            Vec3 u = UnitySpace.Swap(v);
            return new Vector3((float)u.X, (float)u.Y, (float)u.Z);
        }

        /// <summary>Converts a rotation to Unity's axes.</summary>
        public static Quaternion ToUnity(Quat q)
        {
            Quat u = UnitySpace.Swap(q);
            return new Quaternion((float)u.X, (float)u.Y, (float)u.Z, (float)u.W);
        }

        /// <summary>Returns whether the wire accepts a position: finite, and at most 10 m along each axis.</summary>
        public static bool IsInRange(Vec3 v)
        {
            return System.Math.Abs(v.X) <= Protocol.MaxCoordinate && System.Math.Abs(v.Y) <= Protocol.MaxCoordinate
                && System.Math.Abs(v.Z) <= Protocol.MaxCoordinate;
        }
    }
}
