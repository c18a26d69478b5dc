namespace Pacinian
{
    /// <summary>A new pose of an object, in the array's frame, and its velocity.</summary>
    public struct Movement
    {
        /// <summary>The position [m].</summary>
        public Vec3 Position;

        /// <summary>The rotation. All zeros, the default of C#, are no rotation.</summary>
        public Quat Rotation;

        /// <summary>The velocity [m/s], and the angular velocity about the frame's axes [rad/s].</summary>
        public Vec3 Velocity, AngularVelocity;

        /// <summary>Whether the velocities are known.</summary>
        public bool Moving;

        /// <summary>Creates a pose without velocity.</summary>
        public Movement(Vec3 position, Quat rotation)
        {
            Position = position;
            Rotation = rotation;
            Velocity = AngularVelocity = new Vec3();
            Moving = false;
        }
    }
}
