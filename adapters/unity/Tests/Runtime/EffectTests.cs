using NUnit.Framework;
using Pacinian.Wire;
using UnityEngine;

namespace Pacinian.Haptics.Tests
{
    public sealed class EffectTests
    {
        private readonly GameObject _owner = new GameObject("effect");

        [TearDown]
        public void Clean()
        {
            UnityEngine.Object.DestroyImmediate(_owner);
        }

        [TestCase(TechniqueKind.Server)]
        [TestCase(TechniqueKind.Simultaneous)]
        [TestCase(TechniqueKind.AM)]
        [TestCase(TechniqueKind.STM)]
        [TestCase(TechniqueKind.LM)]
        public void EachTechniqueIsTaken(TechniqueKind kind)
        {
            ITechnique made = new HapticTechnique { kind = kind }.Message;
            Assert.AreEqual("", Checking.Problem(new Point { Technique = made }, new Point()));
            Assert.AreEqual(kind == TechniqueKind.Server, made == null);
        }

        [Test]
        public void WhatTheServerWouldRefuseIsFoundHere()
        {
            Point point = new Point { RadiationPressure = -1.0 };
            Assert.IsTrue(Checking.Problem(point, new Point()).Contains("radiation_pressure"));
            point = new Point { Position = new Vec3(double.NaN, 0.0, 0.0) };
            Assert.IsTrue(Checking.Problem(point, new Point()).Contains("position"));
        }

        [Test]
        public void ItPlaysWhileItIsEnabled()
        {
            HapticPoint point = _owner.AddComponent<HapticPoint>();
            Assert.IsTrue(point.Playing);
            Assert.IsTrue(point.WireName.StartsWith("effect "));
            point.enabled = false;
            Assert.IsFalse(point.Playing);
            point.Play();
            Assert.IsFalse(point.Playing);
        }

        [Test]
        public void AnOpenHandIsAHand()
        {
            _owner.transform.position = new Vector3(1f, 2f, 3f);
            HapticHand hand = _owner.AddComponent<HapticHand>();
            OpenHand open = _owner.AddComponent<OpenHand>();
            hand.Provider = open;
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
            open.enabled = false;
            frame = hand.Frame(Rigid.Identity, 0.02);
            Assert.IsFalse(hand.Tracked);
            Assert.AreEqual(0, frame.Joints.Numbers + frame.Radii.Numbers + frame.Velocities.Numbers);
        }
    }
}
