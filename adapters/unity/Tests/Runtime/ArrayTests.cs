using System.IO;
using NUnit.Framework;
using UnityEngine;

namespace Pacinian.Haptics.Tests
{
    public sealed class ArrayTests
    {
        private GameObject _space, _array;

        [SetUp]
        public void Stand()
        {
            _space = new GameObject("tracked space");
            _array = new GameObject("array");
            _space.transform.position = new Vector3(5f, 1f, -3f);
            _space.transform.rotation = Quaternion.AngleAxis(70f, Vector3.up);
            _array.transform.SetParent(_space.transform, false);
            ArrayOrigin origin = _array.AddComponent<ArrayOrigin>();
            origin.CalibrationName = "tests"; // the project's own calibration stays
            origin.KnownPoints = new[]
            {
                new Vector3(-0.285f, 0f, -0.23f), new Vector3(0.285f, 0f, -0.23f), new Vector3(0.285f, 0f, 0.23f),
            };
        }

        [TearDown]
        public void Clean()
        {
            _array.GetComponent<ArrayOrigin>().ForgetCalibration();
            UnityEngine.Object.DestroyImmediate(_array);
            UnityEngine.Object.DestroyImmediate(_space);
        }

        [Test]
        public void AboveTheArrayIsItsNormal()
        {
            ArrayOrigin origin = _array.GetComponent<ArrayOrigin>();
            Assert.IsTrue(ArrayOrigin.Current == origin);
            Vector3 above = _array.transform.TransformPoint(new Vector3(0f, 0.2f, 0f));
            Vec3 place = ArrayOrigin.ToArray.Point(WireSpace.ToWire(above));
            Assert.AreEqual(0.0, (place - new Vec3(0.0, 0.0, 0.2)).Length, 1e-5);
        }

        [TestCase(1f)]
        [TestCase(2f)]
        public void TouchingKnownPointsFindsItAndItStays(float scale)
        {
            ArrayOrigin origin = _array.GetComponent<ArrayOrigin>();
            string problem;
            GameObject truth = new GameObject("where it really stands");
            _space.transform.localScale = new Vector3(scale, scale, scale);
            truth.transform.SetParent(_space.transform, false);
            truth.transform.localScale = new Vector3(1f / scale, 1f / scale, 1f / scale);
            truth.transform.localPosition = new Vector3(0.3f, 0.75f, 0.5f);
            truth.transform.localRotation = Quaternion.AngleAxis(30f, new Vector3(1f, 2f, 0.5f));
            Assert.IsTrue(origin.BeginAlignment());
            Vector3 point;
            while (origin.GetNextPoint(out point))
            {
                origin.TouchPoint(truth.transform.TransformPoint(point));
            }
            Assert.AreEqual(3, origin.Touched);
            Assert.IsTrue(origin.FinishAlignment(out problem), problem);
            Same(truth.transform);
            Assert.IsTrue(origin.Worst < 1e-4f);
            Assert.IsTrue(origin.SaveCalibration(out problem), problem);

            _array.transform.localPosition = Vector3.zero;
            _array.transform.localRotation = Quaternion.identity;
            Assert.IsTrue(origin.LoadCalibration(out problem), problem);
            Same(truth.transform);
            origin.ForgetCalibration();
            Assert.IsFalse(origin.LoadCalibration(out problem));
            UnityEngine.Object.DestroyImmediate(truth);
        }

        [Test]
        public void PointsOnALineAreRefused()
        {
            ArrayOrigin origin = _array.GetComponent<ArrayOrigin>();
            string problem;
            origin.BeginAlignment();
            for (int i = 0; i < 3; i++)
            {
                origin.TouchPoint(new Vector3(0.1f * i, 0f, 0f));
            }
            Assert.IsFalse(origin.FinishAlignment(out problem));
            Assert.IsTrue(problem.Contains("touch others farther apart"), problem);
            origin.CancelAlignment();
            Assert.AreEqual(0, origin.Touched);
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
            string problem;
            Assert.IsFalse(origin.LoadCalibration(out problem));
            Assert.IsTrue(problem.Contains(says), problem);
            Assert.AreEqual(0.0, _array.transform.localPosition.magnitude, 0.0);
        }

        private void Same(Transform truth)
        {
            Vector3 point = new Vector3(0.1f, 0.2f, 0.3f);
            Transform found = _array.transform;
            Vector3 apart = truth.position + truth.rotation * point - (found.position + found.rotation * point);
            Assert.AreEqual(0.0, apart.magnitude, 1e-4);
        }
    }
}
