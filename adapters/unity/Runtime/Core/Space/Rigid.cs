namespace Pacinian
{
    /// <summary>A rotation, then a translation: where a frame is in another, and how to get from the one to the other.</summary>
    public struct Rigid
    {
        /// <summary>How the frame is turned.</summary>
        public Quat Rotation;

        /// <summary>Where its origin is [m].</summary>
        public Vec3 Position;

        /// <summary>From its two parts.</summary>
        public Rigid(Vec3 position, Quat rotation)
        {
            Position = position;
            Rotation = rotation;
        }

        /// <summary>The same frame.</summary>
        public static Rigid Identity
        {
            get { return new Rigid(new Vec3(), Quat.Identity); }
        }

        /// <summary>First b, then a.</summary>
        public static Rigid operator *(Rigid a, Rigid b)
        {
            return new Rigid(a.Point(b.Position), a.Rotation * b.Rotation);
        }

        /// <summary>The way back.</summary>
        public Rigid Inverse
        {
            get
            {
                Quat back = Rotation.Inverse;
                return new Rigid(-1.0 * back.Turn(Position), back);
            }
        }

        /// <summary>A place in the other frame.</summary>
        public Vec3 Point(Vec3 place)
        {
            return Rotation.Turn(place) + Position;
        }

        /// <summary>A direction or velocity, also an angular one, in the other frame.</summary>
        public Vec3 Direction(Vec3 direction)
        {
            return Rotation.Turn(direction);
        }
    }
}
