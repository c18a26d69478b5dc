namespace Pacinian.Wire
{
    /// <summary>Two numbers along x and y.</summary>
    public struct Vec2
    {
        /// <summary>The components.</summary>
        public double X, Y;

        public Vec2(double x, double y)
        {
            X = x;
            Y = y;
        }
    }

    /// <summary>Two integers: rows and columns, or major and minor.</summary>
    public struct Int2
    {
        /// <summary>The first and the second.</summary>
        public long X, Y;

        public Int2(long x, long y)
        {
            X = x;
            Y = y;
        }
    }

    /// <summary>Three integers, such as the numbers of voxels in x, y and z.</summary>
    public struct Int3
    {
        /// <summary>The components.</summary>
        public long X, Y, Z;

        public Int3(long x, long y, long z)
        {
            X = x;
            Y = y;
            Z = z;
        }
    }

    /// <summary>Writes arrays of a fixed length.</summary>
    public static class Tuples
    {
        /// <summary>Writes two numbers.</summary>
        public static void Fixed(this Writer w, Vec2 value)
        {
            w.Array(2);
            w.Real(value.X);
            w.Real(value.Y);
        }

        /// <summary>Writes three numbers.</summary>
        public static void Fixed(this Writer w, Vec3 value)
        {
            w.Array(3);
            w.Real(value.X);
            w.Real(value.Y);
            w.Real(value.Z);
        }

        /// <summary>Writes four numbers.</summary>
        public static void Fixed(this Writer w, Quat value)
        {
            w.Array(4);
            w.Real(value.X);
            w.Real(value.Y);
            w.Real(value.Z);
            w.Real(value.W);
        }

        /// <summary>Writes two integers.</summary>
        public static void Fixed(this Writer w, Int2 value)
        {
            w.Array(2);
            w.Whole(value.X);
            w.Whole(value.Y);
        }

        /// <summary>Writes three integers.</summary>
        public static void Fixed(this Writer w, Int3 value)
        {
            w.Array(3);
            w.Whole(value.X);
            w.Whole(value.Y);
            w.Whole(value.Z);
        }
    }
}
