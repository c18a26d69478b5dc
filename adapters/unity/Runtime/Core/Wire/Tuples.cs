namespace Pacinian.Wire
{
    /// <summary>Two numbers, along x and y.</summary>
    public struct Vec2
    {
        /// <summary>Along the axes.</summary>
        public double X, Y;

        /// <summary>From its two numbers.</summary>
        public Vec2(double x, double y)
        {
            X = x;
            Y = y;
        }
    }

    /// <summary>Two whole numbers: rows and columns, or major and minor.</summary>
    public struct Int2
    {
        /// <summary>The first and the second.</summary>
        public long X, Y;

        /// <summary>From its two numbers.</summary>
        public Int2(long x, long y)
        {
            X = x;
            Y = y;
        }
    }

    /// <summary>Three whole numbers: of voxels, in x, y and z.</summary>
    public struct Int3
    {
        /// <summary>Along the axes.</summary>
        public long X, Y, Z;

        /// <summary>From its three numbers.</summary>
        public Int3(long x, long y, long z)
        {
            X = x;
            Y = y;
            Z = z;
        }
    }

    /// <summary>Writes arrays that always have as many numbers.</summary>
    public static class Tuples
    {
        /// <summary>An array of two numbers.</summary>
        public static void Fixed(this Writer w, Vec2 value)
        {
            w.Array(2);
            w.Real(value.X);
            w.Real(value.Y);
        }

        /// <summary>An array of three numbers.</summary>
        public static void Fixed(this Writer w, Vec3 value)
        {
            w.Array(3);
            w.Real(value.X);
            w.Real(value.Y);
            w.Real(value.Z);
        }

        /// <summary>An array of four numbers.</summary>
        public static void Fixed(this Writer w, Quat value)
        {
            w.Array(4);
            w.Real(value.X);
            w.Real(value.Y);
            w.Real(value.Z);
            w.Real(value.W);
        }

        /// <summary>An array of two whole numbers.</summary>
        public static void Fixed(this Writer w, Int2 value)
        {
            w.Array(2);
            w.Whole(value.X);
            w.Whole(value.Y);
        }

        /// <summary>An array of three whole numbers.</summary>
        public static void Fixed(this Writer w, Int3 value)
        {
            w.Array(3);
            w.Whole(value.X);
            w.Whole(value.Y);
            w.Whole(value.Z);
        }
    }
}
