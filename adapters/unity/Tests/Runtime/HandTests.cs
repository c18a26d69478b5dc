using NUnit.Framework;
using Pacinian.Wire;
using UnityEngine;

namespace Pacinian.Haptics.Tests
{
    public sealed class HandTests
    {
        private GameObject _owner;

        [SetUp]
        public void Stand()
        {
            _owner = new GameObject("owner");
        }

        [TearDown]
        public void Clean()
        {
            UnityEngine.Object.DestroyImmediate(_owner);
        }

        [TestCase(0f)]
        [TestCase(-1f)]
        [TestCase(float.NaN)]
        public void AQuietZoneIsAlwaysOneThatTheServerTakes(float pressure)
        {
            QuietZone zone = _owner.AddComponent<QuietZone>();
            zone.Pressure = pressure;
            zone.Radius = pressure;
            Zone written = new Zone();
            bool changed = false;
            zone.Write(Rigid.Identity, written, ref changed);
            Assert.IsTrue(changed && written.Pressure > 0.0 && written.Radius >= 0.0 && written.Radius <= 1.0);
            changed = false;
            zone.Write(Rigid.Identity, written, ref changed);
            Assert.IsFalse(changed);
        }

        [Test]
        public void AnOpenHandIsAHand()
        {
            _owner.transform.position = new Vector3(1f, 2f, 3f);
            HapticHand hand = _owner.AddComponent<HapticHand>();
            hand.Source = HapticHandSource.Open;
            HandFrame frame = hand.Frame(Rigid.Identity, 0.0);
            Assert.IsTrue(hand.Tracked);
            Assert.AreEqual(78, frame.Joints.Numbers);
            Assert.AreEqual(26, frame.Radii.Numbers);
            Assert.AreEqual(0, frame.Velocities.Numbers);
            Assert.AreEqual(0.0, (frame.Joints.Point(0) - new Vec3(1.0, 3.0, 2.0)).Length, 1e-6);
            Assert.IsTrue(frame.Joints.Point(5).X < 1.0, "the thumb of a right hand, palm down, is on its left");

            _owner.transform.position = new Vector3(1.01f, 2f, 3f);
            frame = hand.Frame(Rigid.Identity, 0.01);
            Assert.AreEqual(1.0, frame.Velocities.Single(0), 1e-3);
            hand.Source = HapticHandSource.Tracker;
            frame = hand.Frame(Rigid.Identity, 0.02);
            Assert.IsFalse(hand.Tracked);
            Assert.AreEqual(0, frame.Joints.Numbers + frame.Radii.Numbers + frame.Velocities.Numbers);
        }

        [Test]
        public void EachHandHasANameOfItsOwn()
        {
            HapticHand[] hands = new HapticHand[4];
            for (int i = 0; i < hands.Length; i++)
            {
                hands[i] = _owner.AddComponent<HapticHand>();
                hands[i].Side = i == 0 ? HandFrameSide.Left : HandFrameSide.Right;
            }
            string[] wanted = { "left", "right", "right 2", "right 3" };
            for (int turn = 0; turn < 2; turn++)
            {
                for (int i = 0; i < hands.Length; i++)
                {
                    Assert.AreEqual(wanted[i], hands[i].Frame(Rigid.Identity, 0.0).Name);
                }
            }
            hands[1].enabled = false;
            Assert.AreEqual("right 2", hands[2].Frame(Rigid.Identity, 0.0).Name);
            hands[0].Side = HandFrameSide.Right;
            Assert.AreEqual("right", hands[0].Frame(Rigid.Identity, 0.0).Name);
        }

        [Test]
        public void TheGameMayGiveTheJoints()
        {
            HapticHand hand = _owner.AddComponent<HapticHand>();
            hand.Source = HapticHandSource.Game;
            hand.Frame(Rigid.Identity, 0.0);
            Assert.IsFalse(hand.Tracked);
            hand.SetJoints(new Vector3[HapticHand.Count]);
            Assert.AreEqual(78, hand.Frame(Rigid.Identity, 0.0).Joints.Numbers);
            Assert.AreEqual(0, hand.Frame(Rigid.Identity, 0.0).Radii.Numbers);
            float[] radii = new float[HapticHand.Count];
            for (int i = 0; i < radii.Length; i++)
            {
                radii[i] = 0.008f;
            }
            hand.SetRadii(radii);
            Assert.AreEqual(26, hand.Frame(Rigid.Identity, 0.0).Radii.Numbers);
            hand.SetLost();
            Assert.AreEqual(0, hand.Frame(Rigid.Identity, 0.0).Joints.Numbers);
            Assert.IsFalse(hand.Tracked);
        }
    }
}
