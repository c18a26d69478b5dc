using System.Reflection;
using NUnit.Framework;
using Pacinian.Wire;
using UnityEngine;

namespace Pacinian.Haptics.Tests
{
    public sealed class EffectTests
    {
        private const BindingFlags Own = BindingFlags.Instance | BindingFlags.NonPublic;

        private GameObject _owner;

        [SetUp]
        public void Stand()
        {
            _owner = new GameObject("effect");
        }

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
        public void EachEffectHasANameOfItsOwn()
        {
            HapticPoint[] points = { _owner.AddComponent<HapticPoint>(), _owner.AddComponent<HapticPoint>() };
            string emoji = "\uD83D\uDE00", wanted = new string('a', 63) + emoji;
            foreach (HapticPoint point in points)
            {
                point.enabled = false;
                point.EffectName = wanted;
                point.enabled = true;
            }
            Assert.AreEqual(new string('a', 63), points[0].WireName, "no half of a character");
            Assert.AreEqual(new string('a', 58) + " 2", points[1].WireName);
            points[0].enabled = false;
            Assert.IsTrue(HapticEffect.Named(points[1].WireName) == points[1]);
        }

        [Test]
        public void WhatWasRefusedIsNotSentAgainAndKeepsItsProblem()
        {
            HapticPoint[] points = new HapticPoint[3];
            FieldInfo there = typeof(HapticEffect).GetField("_there", Own), changed = typeof(HapticEffect).GetField("_changed", Own);
            using (HapticClient client = new HapticClient(new Options()))
            {
                for (int i = 0; i < points.Length; i++)
                {
                    points[i] = _owner.AddComponent<HapticPoint>();
                    there.SetValue(points[i], 1);
                    changed.SetValue(points[i], false);
                }
                for (int i = 0; i < 2; i++)
                {
                    string path = "$.objects[" + points[i].WireName + "].force";
                    HapticEffect.Refuse(client, new Refusal { Path = path, Message = "wrong " + i });
                }
                Assert.AreEqual("wrong 0", points[0].Problem);
                Assert.AreEqual("wrong 1", points[1].Problem);
                Assert.IsFalse((bool)changed.GetValue(points[0]));
                Assert.IsTrue((bool)changed.GetValue(points[2]));
                typeof(HapticEffect).GetField("_put", Own).SetValue(points[2], Time.realtimeSinceStartupAsDouble);
                HapticEffect.Refuse(client, new Refusal { Path = "$.objects", Message = "too many" });
                Assert.AreEqual("too many", points[2].Problem);
                Assert.AreEqual("wrong 0", points[0].Problem);
            }
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

#if PACINIAN_STUBS // Unity draws only while it calls OnDrawGizmosSelected
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
#endif
    }
}
