namespace Pacinian
{
    /// <summary>
    /// Unity's frame (left-handed, y up, metres) and the world's (right-handed, z up, metres): y and z change places.
    /// That is a reflection, so each of these maps is its own inverse, and what turns also changes its sign.
    /// </summary>
    public static class UnitySpace
    {
        /// <summary>A place, direction or velocity, in either direction.</summary>
        public static Vec3 Swap(Vec3 v)
        {
            return new Vec3(v.X, v.Z, v.Y);
        }

        /// <summary>A rotation, in either direction.</summary>
        public static Quat Swap(Quat q)
        {
            return new Quat(-q.X, -q.Z, -q.Y, q.W);
        }

        /// <summary>Where a frame is, in either direction.</summary>
        public static Rigid Swap(Rigid frame)
        {
            return new Rigid(Swap(frame.Position), Swap(frame.Rotation));
        }

        /// <summary>An angular velocity, in either direction: the axis is swapped and turned round.</summary>
        public static Vec3 SwapAngular(Vec3 velocity)
        {
            return -1.0 * Swap(velocity);
        }
    }
}
