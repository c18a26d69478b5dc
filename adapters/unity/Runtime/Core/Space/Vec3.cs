using System;
using System.Globalization;

namespace Pacinian
{
    /// <summary>Three numbers along x, y and z: a place, a direction, a velocity.</summary>
    public struct Vec3
    {
        /// <summary>Along the axes.</summary>
        public double X, Y, Z;

        /// <summary>From its three numbers.</summary>
        public Vec3(double x, double y, double z)
        {
            X = x;
            Y = y;
            Z = z;
        }

        /// <summary>As (0.1, -2, 30).</summary>
        public override string ToString()
        {
            return string.Format(CultureInfo.InvariantCulture, "({0}, {1}, {2})", X, Y, Z);
        }

        /// <summary>The sum.</summary>
        public static Vec3 operator +(Vec3 a, Vec3 b)
        {
            return new Vec3(a.X + b.X, a.Y + b.Y, a.Z + b.Z);
        }

        /// <summary>The difference.</summary>
        public static Vec3 operator -(Vec3 a, Vec3 b)
        {
            return new Vec3(a.X - b.X, a.Y - b.Y, a.Z - b.Z);
        }

        /// <summary>So many times as long.</summary>
        public static Vec3 operator *(double s, Vec3 a)
        {
            return new Vec3(s * a.X, s * a.Y, s * a.Z);
        }

        /// <summary>The scalar product.</summary>
        public static double Dot(Vec3 a, Vec3 b)
        {
            return a.X * b.X + a.Y * b.Y + a.Z * b.Z;
        }

        /// <summary>The vector product, in a right-handed frame.</summary>
        public static Vec3 Cross(Vec3 a, Vec3 b)
        {
            return new Vec3(a.Y * b.Z - a.Z * b.Y, a.Z * b.X - a.X * b.Z, a.X * b.Y - a.Y * b.X);
        }

        /// <summary>How long it is.</summary>
        public double Length
        {
            get { return Math.Sqrt(Dot(this, this)); }
        }
    }
}
