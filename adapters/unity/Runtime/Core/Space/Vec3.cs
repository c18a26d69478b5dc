using System;
using System.Globalization;

namespace Pacinian
{
    /// <summary>Three numbers along x, y and z: a position, direction or velocity.</summary>
    public struct Vec3
    {
        /// <summary>The components.</summary>
        public double X, Y, Z;

        public Vec3(double x, double y, double z)
        {
            X = x;
            Y = y;
            Z = z;
        }

        /// <summary>Returns a text such as (0.1, -2, 30).</summary>
        public override string ToString()
        {
            return string.Format(CultureInfo.InvariantCulture, "({0}, {1}, {2})", X, Y, Z);
        }

        /// <summary>Returns the sum.</summary>
        public static Vec3 operator +(Vec3 a, Vec3 b)
        {
            return new Vec3(a.X + b.X, a.Y + b.Y, a.Z + b.Z);
        }

        /// <summary>Returns the difference.</summary>
        public static Vec3 operator -(Vec3 a, Vec3 b)
        {
            return new Vec3(a.X - b.X, a.Y - b.Y, a.Z - b.Z);
        }

        /// <summary>Returns the scaled vector.</summary>
        public static Vec3 operator *(double s, Vec3 a)
        {
            return new Vec3(s * a.X, s * a.Y, s * a.Z);
        }

        /// <summary>Returns the scalar product.</summary>
        public static double Dot(Vec3 a, Vec3 b)
        {
            return a.X * b.X + a.Y * b.Y + a.Z * b.Z;
        }

        /// <summary>Returns the vector product, in a right-handed frame.</summary>
        public static Vec3 Cross(Vec3 a, Vec3 b)
        {
            return new Vec3(a.Y * b.Z - a.Z * b.Y, a.Z * b.X - a.X * b.Z, a.X * b.Y - a.Y * b.X);
        }

        /// <summary>The length.</summary>
        public double Length
        {
            get { return Math.Sqrt(Dot(this, this)); }
        }
    }
}
