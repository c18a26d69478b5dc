using NUnit.Framework;
using UnityEngine;

namespace Pacinian.Haptics.Tests
{
    public sealed class MeshShapeTests
    {
        [TestCase(1f)]
        [TestCase(-2f)]
        public void ACubeIsClosedAndFacesOutward(float scale)
        {
            string problem;
            Wire.HapticMesh made = MeshShape.Of(Shapes.Cube(), new Vector3(1f, scale, 1f), out problem);
            Assert.AreEqual("", problem);
            Assert.AreEqual(8, made.Vertices.Numbers / 3, "welded");
            Assert.AreEqual(12, made.Faces.Numbers / 3);
            for (int i = 0; i < 12; i++)
            {
                Vec3 a = Corner(made, 3 * i), b = Corner(made, 3 * i + 1), c = Corner(made, 3 * i + 2);
                Vec3 middle = 1.0 / 3.0 * (a + b + c);
                Assert.IsTrue(Vec3.Dot(Vec3.Cross(b - a, c - a), middle) > 0.0, "face " + i + " faces inward");
            }
        }

        [Test]
        public void AxesAreTheWires()
        {
            string problem;
            Wire.HapticMesh made = MeshShape.Of(Shapes.Cube(), new Vector3(1f, 2f, 3f), out problem);
            Vec3 corner = made.Vertices.Point(0);
            Assert.AreEqual(0.5, System.Math.Abs(corner.X), 1e-6);
            Assert.AreEqual(1.5, System.Math.Abs(corner.Y), 1e-6, "Unity's z");
            Assert.AreEqual(1.0, System.Math.Abs(corner.Z), 1e-6, "Unity's y");
        }

        [Test]
        public void WhatCannotBeSaysWhy()
        {
            string problem;
            Assert.IsNull(MeshShape.Of(null, Vector3.one, out problem));
            Assert.AreEqual("has no mesh", problem);
            Assert.IsNull(MeshShape.Of(new Mesh(), Vector3.one, out problem));
            Assert.AreEqual("its mesh has no triangles", problem);
        }

        private static Vec3 Corner(Wire.HapticMesh mesh, int index)
        {
            return mesh.Vertices.Point((int)mesh.Faces.Index(index));
        }
    }
}
