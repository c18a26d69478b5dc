using System;

namespace Pacinian.Haptics
{
    /// <summary>
    /// Estimates the velocity of a frame from its poses, so that the server can extrapolate between two frames of the
    /// game.
    /// </summary>
    internal struct Velocity
    {
        private const double Longest = 0.2; // [s] longest time between two poses of one movement
        private const double Fastest = 10.0; // [m/s], and times 5 [rad/s]; faster is a jump

        private Rigid _pose;
        private double _time;
        private bool _known, _moving;

        /// <summary>Forgets the last pose.</summary>
        public void Forget()
        {
            _known = _moving = false;
        }

        /// <summary>
        /// Takes the present pose and time [s]; writes the movement, with a velocity if it is known. Returns false if
        /// nothing has changed, so that nothing need be sent.
        /// </summary>
        public bool Next(Rigid pose, double now, out Movement movement)
        {
            movement = new Movement(pose.Position, pose.Rotation);
            bool same = _known && Same(pose, _pose);
            bool tell = !same || _moving;
            double step = now - _time;
            if (tell && _known && step > 0.0 && step < Longest)
            {
                movement.Velocity = (1.0 / step) * (pose.Position - _pose.Position);
                movement.AngularVelocity = Turning(_pose.Rotation, pose.Rotation, step);
                movement.Moving = movement.Velocity.Length < Fastest && movement.AngularVelocity.Length < 5.0 * Fastest;
            }
            if (!movement.Moving)
            {
                movement.Velocity = movement.AngularVelocity = new Vec3();
            }
            _moving = movement.Moving && !same;
            _pose = pose;
            _time = now;
            _known = true;
            return tell;
        }

        private static bool Same(Rigid a, Rigid b)
        {
            return a.Position.X == b.Position.X && a.Position.Y == b.Position.Y && a.Position.Z == b.Position.Z
                && a.Rotation.X == b.Rotation.X && a.Rotation.Y == b.Rotation.Y
                && a.Rotation.Z == b.Rotation.Z && a.Rotation.W == b.Rotation.W;
        }

        /// <summary>Returns the angular velocity about the world's axes [rad/s].</summary>
        private static Vec3 Turning(Quat from, Quat to, double step)
        {
            Quat turn = to * from.Inverse;
            double sign = turn.W < 0.0 ? -1.0 : 1.0;
            Vec3 axis = new Vec3(turn.X, turn.Y, turn.Z);
            double sine = axis.Length;
            return sine < 1e-9 ? new Vec3() : (sign * 2.0 * Math.Atan2(sine, sign * turn.W) / (sine * step)) * axis;
        }
    }
}
