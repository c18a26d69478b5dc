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
            Assert.AreEqual("", ObjectValidation.Problem(new Point { RadiationPressure = 1.0, Technique = made }));
            Assert.AreEqual(kind == TechniqueKind.Server, made == null);
        }

        [Test]
        public void WhatTheServerWouldRefuseIsFoundHere()
        {
            Point point = new Point { RadiationPressure = -1.0 };
            Assert.IsTrue(ObjectValidation.Problem(point).Contains("radiation_pressure"));
            point = new Point { RadiationPressure = 1.0, Position = new Vec3(double.NaN, 0.0, 0.0) };
            Assert.IsTrue(ObjectValidation.Problem(point).Contains("position"));
        }

        [Test]
        public void ItPlaysWhileItIsEnabled()
        {
            HapticPoint point = _owner.AddComponent<HapticPoint>();
            Assert.IsTrue(point.Playing);
            Assert.IsTrue(point.WireName.StartsWith("effect "));
            point.Force = 0.01f;
            Assert.IsTrue(point.Strength == HapticStrength.Force);
            point.enabled = false;
            Assert.IsFalse(point.Playing);
            point.Play();
            Assert.IsFalse(point.Playing);
        }

        [Test]
        public void StrengthMayBeAShareOfTheProjectsFullPressure()
        {
            HapticPoint point = _owner.AddComponent<HapticPoint>();
            Assert.AreEqual(0.4, point.RelativeStrength, 1e-6, "8 of 20 Pa");
            point.Strength = HapticStrength.Force;
            point.RelativeStrength = 2f;
            Assert.AreEqual(20.0, point.RadiationPressure, 1e-6);
            Assert.IsTrue(point.Strength == HapticStrength.RadiationPressure);
        }

        [TestCase("point")]
        [TestCase("disc")]
        [TestCase("rectangle")]
        [TestCase("ball")]
        [TestCase("box")]
        [TestCase("capsule")]
        [TestCase("mesh")]
        public void WhatIsDrawnIsAsLargeAsWhatIsFelt(string kind)
        {
            _owner.transform.position = new Vector3(1f, 2f, 3f);
            _owner.transform.localScale = new Vector3(2f, 2f, 2f);
            HapticEffect effect = kind == "point" ? _owner.AddComponent<HapticPoint>()
                : kind == "disc" || kind == "rectangle" ? (HapticEffect)_owner.AddComponent<HapticSurface>()
                : _owner.AddComponent<HapticVolume>();
            double high = 0.0;
            switch (kind)
            {
                case "point": ((HapticPoint)effect).Diameter = 0.01f; high = 0.005; break;
                case "disc": ((HapticSurface)effect).Shape = HapticSurfaceShape.Disc; break;
                case "rectangle": ((HapticSurface)effect).Shape = HapticSurfaceShape.Rectangle; break;
                case "ball": _owner.AddComponent<SphereCollider>().radius = 0.03f; high = 0.06; break;
                case "box": _owner.AddComponent<BoxCollider>().size = new Vector3(0.1f, 0.2f, 0.3f); high = 0.2; break;
                case "capsule": Capsule(_owner.AddComponent<CapsuleCollider>()); high = 0.1; break;
                default: _owner.AddComponent<MeshCollider>().sharedMesh = Shapes.Cube(); high = 1.0; break;
            }
            Gizmos.Lines.Clear();
            effect.SendMessage("OnDrawGizmosSelected");
            Assert.AreEqual("", effect.Problem);
            Assert.IsTrue(Gizmos.Lines.Count > 0);
            double highest = 0.0, widest = 0.0;
            foreach (Vector3 place in Gizmos.Lines)
            {
                highest = System.Math.Max(highest, place.y - 2.0);
                widest = System.Math.Max(widest, System.Math.Abs(place.x - 1.0));
            }
            Assert.AreEqual(high, highest, 1e-5);
            Assert.AreEqual(kind == "disc" || kind == "rectangle" ? 0.1 : widest, widest, 1e-5);
        }

        [Test]
        public void AnEffectThatIsDrawnIsToldWhenItsShapeChanges()
        {
            SphereCollider sphere = _owner.AddComponent<SphereCollider>();
            HapticVolume volume = _owner.AddComponent<HapticVolume>();
            volume.SendMessage("OnDrawGizmosSelected");
            sphere.enabled = false;
            volume.Stop();
            volume.SendMessage("OnDrawGizmosSelected");
            Assert.IsTrue(volume.Problem.StartsWith("has no collider"), "also where it does not play");
        }

        private static void Capsule(CapsuleCollider capsule)
        {
            capsule.radius = 0.01f;
            capsule.height = 0.1f;
        }

        [Test]
        public void ItIsToldOnceThatItsDurationIsOver()
        {
            HapticPoint point = _owner.AddComponent<HapticPoint>();
            int finished = 0;
            point.Finished += () => finished++;
            point.Duration = 0.5f;
            point.Play();
            for (double late = 1.0; late < 3.0; late++)
            {
                point.Send(null, 1, Rigid.Identity, Time.realtimeSinceStartupAsDouble + late);
            }
            Assert.AreEqual(1, finished);
            Assert.IsFalse(point.Playing);
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
