namespace Pacinian
{
    /// <summary>
    /// Converts between Unity's frame (left-handed, y up, metres) and the world's (right-handed, z up, metres) by
    /// swapping y and z. Because this is a reflection, each map is its own inverse, and rotations also change their
    /// sign.
    /// </summary>
    public static class UnitySpace
    {
        /// <summary>Converts a position, direction or velocity, either way.</summary>
        public static Vec3 Swap(Vec3 v)
        {
            return new Vec3(v.X, v.Z, v.Y);
        }

        /// <summary>Converts a rotation, either way.</summary>
        public static Quat Swap(Quat q)
        {
            return new Quat(-q.X, -q.Z, -q.Y, q.W);
        }

        /// <summary>Converts a pose, either way.</summary>
        public static Rigid Swap(Rigid frame)
        {
            return new Rigid(Swap(frame.Position), Swap(frame.Rotation));
        }

        /// <summary>Converts an angular velocity, either way: swaps the axis and reverses it.</summary>
        public static Vec3 SwapAngular(Vec3 velocity)
        {
            return -1.0 * Swap(velocity);
        }
    }
}
