using System.IO;
using NUnit.Framework;
using UnityEngine;

namespace Pacinian.Haptics.Tests
{
    public sealed class ArrayTests
    {
        private readonly GameObject _space = new GameObject("tracked space");
        private readonly GameObject _array = new GameObject("array");

        [SetUp]
        public void Stand()
        {
            _space.transform.position = new Vector3(5f, 1f, -3f);
            _space.transform.rotation = Quaternion.AngleAxis(70f, Vector3.up);
            _array.transform.SetParent(_space.transform, false);
            _array.AddComponent<ArrayAlignment>();
        }

        [TearDown]
        public void Clean()
        {
            File.Delete(_array.GetComponent<ArrayOrigin>().Path);
            UnityEngine.Object.DestroyImmediate(_array);
            UnityEngine.Object.DestroyImmediate(_space);
        }

        [Test]
        public void AboveTheArrayIsItsNormal()
        {
            ArrayOrigin origin = _array.GetComponent<ArrayOrigin>();
            Assert.IsTrue(ArrayOrigin.Current == origin);
            Vector3 above = _array.transform.TransformPoint(new Vector3(0f, 0.2f, 0f));
            Vec3 place = ArrayOrigin.ToArray.Point(Frames.Of(above));
            Assert.AreEqual(0.0, (place - new Vec3(0.0, 0.0, 0.2)).Length, 1e-5);
        }

        [Test]
        public void TouchingKnownPointsFindsItAndItStays()
        {
            ArrayAlignment alignment = _array.GetComponent<ArrayAlignment>();
            GameObject truth = new GameObject("where it really stands");
            truth.transform.SetParent(_space.transform, false);
            truth.transform.localPosition = new Vector3(0.3f, 0.75f, 0.5f);
            truth.transform.localRotation = Quaternion.AngleAxis(30f, new Vector3(1f, 2f, 0.5f));
            foreach (Vector3 point in alignment.KnownPoints)
            {
                alignment.Touch(truth.transform.TransformPoint(point));
            }
            Assert.AreEqual("", alignment.Problem);
            Same(truth.transform);
            Assert.IsTrue(alignment.Worst < 1e-4f);

            _array.transform.localPosition = Vector3.zero;
            _array.transform.localRotation = Quaternion.identity;
            Assert.AreEqual("", _array.GetComponent<ArrayOrigin>().Load());
            Same(truth.transform);
            UnityEngine.Object.DestroyImmediate(truth);
        }

        [Test]
        public void PointsOnALineAreRefusedAndItBeginsAgain()
        {
            ArrayAlignment alignment = _array.GetComponent<ArrayAlignment>();
            for (int i = 0; i < 3; i++)
            {
                alignment.Touch(new Vector3(0.1f * i, 0f, 0f));
            }
            Assert.IsTrue(alignment.Problem.Contains("touch others farther apart"), alignment.Problem);
            Assert.AreEqual(0, alignment.Touched);
            Assert.AreEqual(0.0, _array.transform.localPosition.magnitude, 0.0);
        }

        [TestCase("", "is no stored pose")]
        [TestCase("{", "cannot be read")]
        [TestCase("{}", "is no stored pose")]
        [TestCase("{\"qx\": 0, \"qy\": 0, \"qz\": 0, \"qw\": 3}", "is no stored pose")]
        public void AFileThatIsBrokenChangesNothing(string text, string says)
        {
            ArrayOrigin origin = _array.GetComponent<ArrayOrigin>();
            File.WriteAllText(origin.Path, text);
            Assert.IsTrue(origin.Load().Contains(says), origin.Load());
            Assert.AreEqual(0.0, _array.transform.localPosition.magnitude, 0.0);
        }

        private void Same(Transform truth)
        {
            Vector3 point = new Vector3(0.1f, 0.2f, 0.3f);
            float apart = (truth.TransformPoint(point) - _array.transform.TransformPoint(point)).magnitude;
            Assert.AreEqual(0.0, apart, 1e-4);
        }
    }
}
