namespace Pacinian
{
    /// <summary>A new pose of an object, in the world's frame, and how it moves from then on.</summary>
    public struct Movement
    {
        /// <summary>Where [m].</summary>
        public Vec3 Position;

        /// <summary>How it is turned.</summary>
        public Quat Rotation;

        /// <summary>Velocity [m/s], and about the world's axes [rad/s].</summary>
        public Vec3 Velocity, AngularVelocity;

        /// <summary>Whether the velocities are known.</summary>
        public bool Moving;

        /// <summary>A pose, standing still.</summary>
        public Movement(Vec3 position, Quat rotation)
        {
            Position = position;
            Rotation = rotation;
            Velocity = AngularVelocity = new Vec3();
            Moving = false;
        }
    }
}
