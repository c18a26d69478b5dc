using System;

namespace Pacinian.Haptics
{
    /// <summary>
    /// Decides whether a pose is sent, and estimates its velocity from the poses before, so that the server can
    /// extrapolate between two frames of the game.
    /// </summary>
    internal struct MotionTracker
    {
        private const double MinMove = 1e-6; // [m] shortest way that is sent
        private const double MinTurn = 1e-5; // [rad] smallest turn that is sent

        private const double MaxStepTime = 0.2; // [s] longest time between two poses of one movement
        private const double MaxSpeed = 10.0; // [m/s], and times 5 [rad/s]; faster is a jump

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
        /// the pose is the one that was sent last, so that nothing need be sent.
        /// </summary>
        public bool Next(Rigid pose, double now, out Movement movement)
        {
            movement = new Movement(pose.Position, pose.Rotation);
            Vec3 way = pose.Position - _pose.Position;
            Vec3 turn = _known ? Turn(_pose.Rotation, pose.Rotation) : new Vec3();
            bool same = _known && way.Length <= MinMove && turn.Length <= MinTurn;
            bool tell = !same || _moving;
            double step = now - _time;
            if (tell && _known && step > 0.0 && step < MaxStepTime)
            {
                movement.Velocity = (1.0 / step) * way;
                movement.AngularVelocity = (1.0 / step) * turn;
                movement.Moving = movement.Velocity.Length < MaxSpeed && movement.AngularVelocity.Length < 5.0 * MaxSpeed;
            }
            if (!movement.Moving)
            {
                movement.Velocity = movement.AngularVelocity = new Vec3();
            }
            _moving = movement.Moving && !same;
            if (tell)
            {
                _pose = pose; // otherwise the last one that was sent, so that a slow movement adds up
            }
            _time = now;
            _known = true;
            return tell;
        }

        /// <summary>Returns the turn from one rotation to another, about the world's axes [rad].</summary>
        private static Vec3 Turn(Quat from, Quat to)
        {
            Quat turn = to * from.Inverse;
            double sign = turn.W < 0.0 ? -1.0 : 1.0;
            Vec3 axis = new Vec3(turn.X, turn.Y, turn.Z);
            double sine = axis.Length;
            return sine < 1e-9 ? new Vec3() : (sign * 2.0 * Math.Atan2(sine, sign * turn.W) / sine) * axis;
        }
    }
}
