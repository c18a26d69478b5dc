using System.Collections.Generic;
using NUnit.Framework;
using UnityEngine;

namespace Pacinian.Haptics.Tests
{
    /// <summary>
    /// Compares a hand of Ultraleap's trackers with sums over the joints that `pacinian.Hand.leap` makes of the same
    /// bones.
    /// </summary>
    public sealed class LeapTests
    {
        private GameObject _owner;

        [SetUp]
        public void Stand()
        {
            _owner = new GameObject("hand");
        }

        [TearDown]
        public void Clean()
        {
            Object.DestroyImmediate(_owner);
        }

        [Test]
        public void ItIsTheHandThatPythonMakes()
        {
            HapticHand hand = _owner.AddComponent<HapticHand>();
            hand.Source = HapticHandSource.Game;
            List<Vector3> bones = new List<Vector3>();
            List<float> widths = new List<float>();
            for (int digit = 0; digit < 5; digit++)
            {
                for (int bone = 0; bone < 4; bone++)
                {
                    bones.Add(Joint(digit, bone));
                    bones.Add(Joint(digit, bone + 1));
                    widths.Add((1 + (((4 * digit) + bone) % 5)) / 256f);
                }
            }
            hand.SetLeap(bones, widths, new Vector3(0.5f, 0.25f, 0.125f));
            Wire.HandFrame frame = hand.Frame(Rigid.Identity, 0.0);
            Assert.IsTrue(hand.Tracked);
            Vector3 joints = Vector3.zero;
            double radii = 0.0;
            for (int i = 0; i < HapticHand.Count; i++)
            {
                joints += (float)i * hand.Joint(i);
                radii += i * frame.Radii.Single(i);
            }
            Assert.AreEqual(13.53125, joints.x, 1e-4);
            Assert.AreEqual(15.265625, joints.y, 1e-4);
            Assert.AreEqual(21.1171875, joints.z, 1e-4);
            Assert.AreEqual(2.022953125, radii, 1e-5);
            Assert.AreEqual(0.03515625, hand.Joint(0).x, 1e-6);
            Assert.AreEqual(0.0078125, frame.Radii.Single(0), 1e-6);
            hand.SetLeap(bones, new float[3], Vector3.zero);
            hand.Frame(Rigid.Identity, 0.0);
            Assert.IsFalse(hand.Tracked);
        }

        private static Vector3 Joint(int digit, int joint)
        {
            return new Vector3(
                (((7 * digit) + (3 * joint)) % 11) / 128f,
                (((5 * digit) + (2 * joint)) % 13) / 128f,
                (((3 * digit) + (7 * joint)) % 17) / 128f);
        }
    }
}
