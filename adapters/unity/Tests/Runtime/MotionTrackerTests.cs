using NUnit.Framework;

namespace Pacinian.Haptics.Tests
{
    public sealed class MotionTrackerTests
    {
        private MotionTracker _tracker;
        private Movement _movement;

        [SetUp]
        public void Forget()
        {
            _tracker = new MotionTracker();
        }

        [Test]
        public void ItIsTheWayInTheTime()
        {
            Assert.IsTrue(At(0.0, 0.0));
            Assert.IsFalse(_movement.Moving);
            Assert.IsTrue(At(0.01, 0.01));
            Assert.IsTrue(_movement.Moving);
            Assert.AreEqual(1.0, _movement.Velocity.X, 1e-9);
        }

        [Test]
        public void ItsEndIsToldOnce()
        {
            At(0.0, 0.0);
            At(0.01, 0.01);
            Assert.IsTrue(At(0.01, 0.02));
            Assert.AreEqual(0.0, _movement.Velocity.Length, 0.0);
            Assert.IsFalse(At(0.01, 0.03));
        }

        [Test]
        public void ASlowMovementAddsUp()
        {
            At(0.0, 0.0);
            double sent = 0.0;
            for (int frame = 1; frame <= 1000; frame++)
            {
                double x = 3e-7 * frame;
                if (At(x, 0.01 * frame))
                {
                    sent = x;
                }
                Assert.AreEqual(x, sent, 1.01e-6);
            }
        }

        [TestCase(1.0, 0.01)]
        [TestCase(0.01, 1.0)]
        public void AJumpOrAPauseIsNoMovement(double way, double time)
        {
            At(0.0, 0.0);
            Assert.IsTrue(At(way, time));
            Assert.IsFalse(_movement.Moving);
        }

        [TestCase(0.02)]
        [TestCase(-0.02)]
        public void TurningIsAboutTheWorldsAxes(double angle)
        {
            Quat from = new Quat(0.5, 0.5, 0.5, 0.5);
            Quat turn = new Quat(0.0, System.Math.Sin(angle / 2.0), 0.0, System.Math.Cos(angle / 2.0));
            _tracker.Next(new Rigid(new Vec3(), from), 0.0, out _movement);
            Quat to = turn * from;
            _tracker.Next(new Rigid(new Vec3(), new Quat(-to.X, -to.Y, -to.Z, -to.W)), 0.01, out _movement);
            Assert.AreEqual(100.0 * angle, _movement.AngularVelocity.Y, 1e-6);
            Assert.AreEqual(0.0, _movement.AngularVelocity.X, 1e-6);
        }

        private bool At(double x, double now)
        {
            return _tracker.Next(new Rigid(new Vec3(x, 0.0, 0.0), Quat.Identity), now, out _movement);
        }
    }
}
