using System;

namespace Pacinian
{
    /// <summary>A unit quaternion x, y, z, w: a rotation.</summary>
    public struct Quat
    {
        /// <summary>The components; W is the real part.</summary>
        public double X, Y, Z, W;

        public Quat(double x, double y, double z, double w)
        {
            X = x;
            Y = y;
            Z = z;
            W = w;
        }

        /// <summary>No rotation.</summary>
        public static Quat Identity
        {
            get { return new Quat(0.0, 0.0, 0.0, 1.0); }
        }

        /// <summary>Returns the rotation b followed by a.</summary>
        public static Quat operator *(Quat a, Quat b)
        {
            return new Quat(
                a.W * b.X + a.X * b.W + a.Y * b.Z - a.Z * b.Y,
                a.W * b.Y - a.X * b.Z + a.Y * b.W + a.Z * b.X,
                a.W * b.Z + a.X * b.Y - a.Y * b.X + a.Z * b.W,
                a.W * b.W - a.X * b.X - a.Y * b.Y - a.Z * b.Z);
        }

        /// <summary>The inverse rotation.</summary>
        public Quat Inverse
        {
            get { return new Quat(-X, -Y, -Z, W); }
        }

        /// <summary>Returns the rotated vector.</summary>
        public Vec3 Turn(Vec3 v)
        {
            Vec3 axis = new Vec3(X, Y, Z);
            Vec3 t = 2.0 * Vec3.Cross(axis, v);
            return v + W * t + Vec3.Cross(axis, t);
        }

        /// <summary>The same rotation with length one; the identity for zeros and for values that are not finite.</summary>
        public Quat Normalised
        {
            get
            {
                double length = Math.Sqrt(X * X + Y * Y + Z * Z + W * W);
                bool valid = length > 1e-12 && length < 1e12;
                return valid ? new Quat(X / length, Y / length, Z / length, W / length) : Identity;
            }
        }
    }
}
