using Pacinian.Wire;

namespace Pacinian
{
    /// <summary>A hand that feels an object, as the server renders it. Lengths in the array's frame [m].</summary>
    public struct HandTouch
    {
        /// <summary>Name of the object.</summary>
        public string Object;

        /// <summary>Name of the hand; its side if it has none.</summary>
        public string Hand;

        /// <summary>Middle of what is pressed on.</summary>
        public Vec3 Position;

        /// <summary>Highest radiation pressure that is asked for, at full envelope [Pa].</summary>
        public double Pressure;

        /// <summary>That pressure over the object's own, 0..1.</summary>
        public double Strength;

        internal static HandTouch Of(TouchState state)
        {
            return new HandTouch
            {
                Object = state.Object, Hand = state.Hand, Position = state.Position,
                Pressure = state.Pressure, Strength = state.Strength,
            };
        }

        internal bool Same(TouchState state)
        {
            return state.Object == Object && state.Hand == Hand;
        }
    }
}
