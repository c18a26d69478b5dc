using Pacinian.Wire;

namespace Pacinian
{
    /// <summary>A hand that feels an object, as the server renders it. Positions are in the array's frame [m].</summary>
    public struct HandTouch
    {
        /// <summary>The name of the object.</summary>
        public string Object;

        /// <summary>The name of the hand, or its side if it has no name.</summary>
        public string Hand;

        /// <summary>The middle of the contact.</summary>
        public Vec3 Position;

        /// <summary>The highest requested radiation pressure, at the full level of the envelope [Pa].</summary>
        public double Pressure;

        /// <summary>The pressure relative to the object's own, 0..1.</summary>
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
