namespace Pacinian
{
    /// <summary>
    /// A rotation followed by a translation: the pose of a frame in another, and the transform from the first to the
    /// second.
    /// </summary>
    public struct Rigid
    {
        /// <summary>The rotation of the frame.</summary>
        public Quat Rotation;

        /// <summary>The position of the frame's origin [m].</summary>
        public Vec3 Position;

        public Rigid(Vec3 position, Quat rotation)
        {
            Position = position;
            Rotation = rotation;
        }

        /// <summary>The identity.</summary>
        public static Rigid Identity
        {
            get { return new Rigid(new Vec3(), Quat.Identity); }
        }

        /// <summary>Returns the transform b followed by a.</summary>
        public static Rigid operator *(Rigid a, Rigid b)
        {
            return new Rigid(a.Point(b.Position), a.Rotation * b.Rotation);
        }

        /// <summary>The inverse transform.</summary>
        public Rigid Inverse
        {
            get
            {
                Quat back = Rotation.Inverse;
                return new Rigid(-1.0 * back.Turn(Position), back);
            }
        }

        /// <summary>Returns the transformed position.</summary>
        public Vec3 Point(Vec3 place)
        {
            return Rotation.Turn(place) + Position;
        }

        /// <summary>Returns the transformed direction, velocity or angular velocity.</summary>
        public Vec3 Direction(Vec3 direction)
        {
            return Rotation.Turn(direction);
        }
    }
}
