using System.Collections.Generic;
using NUnit.Framework;
using Pacinian.Wire;
using UnityEngine;

namespace Pacinian.Haptics.Tests
{
    public sealed class ColliderShapeTests
    {
        private readonly GameObject _owner = new GameObject("solid");
        private readonly List<Collider> _colliders = new List<Collider>();

        [TearDown]
        public void Clean()
        {
            UnityEngine.Object.DestroyImmediate(_owner);
        }

        [Test]
        public void ABoxElsewhere()
        {
            BoxCollider box = _owner.AddComponent<BoxCollider>();
            box.size = new Vector3(1f, 2f, 3f);
            box.center = new Vector3(0.1f, 0.2f, 0.3f);
            Placed made = (Placed)Made(new Vector3(1f, 1f, -2f));
            Vec3 size = ((Box)made.Shape).Size;
            Near(new Vec3(1.0, 6.0, 2.0), size);
            Near(new Vec3(0.1, -0.6, 0.2), made.Pose.Position);
        }

        [Test]
        public void ASphereTakesTheLargestScale()
        {
            _owner.AddComponent<SphereCollider>().radius = 0.5f;
            Assert.AreEqual(0.15, ((Sphere)Made(new Vector3(0.1f, -0.3f, 0.2f))).Radius, 1e-6);
        }

        [TestCase(0, 1.0, 0.0, 0.0)]
        [TestCase(1, 0.0, 0.0, 1.0)]
        [TestCase(2, 0.0, 1.0, 0.0)]
        public void ACapsuleLiesAlongItsAxis(int direction, double x, double y, double z)
        {
            CapsuleCollider capsule = _owner.AddComponent<CapsuleCollider>();
            capsule.radius = 0.02f;
            capsule.height = 0.1f;
            capsule.direction = direction;
            ISolid made = Made(Vector3.one);
            Placed placed = made as Placed;
            Capsule inside = (Capsule)(placed == null ? (object)made : placed.Shape);
            Quat turn = placed == null ? Quat.Identity : placed.Pose.Rotation;
            Near(new Vec3(x, y, z), turn.Turn(new Vec3(0.0, 0.0, 1.0)));
            Assert.AreEqual(0.06, inside.Length, 1e-6);
        }

        [Test]
        public void AShortCapsuleIsASphere()
        {
            _owner.AddComponent<CapsuleCollider>().height = 0.5f;
            Assert.AreEqual(0.5, ((Sphere)Made(Vector3.one)).Radius, 1e-6);
        }

        [Test]
        public void SeveralAreOneAndThoseDisabledAreNone()
        {
            _owner.AddComponent<SphereCollider>();
            _owner.AddComponent<BoxCollider>();
            Assert.AreEqual(2, ((Union)Made(Vector3.one)).Parts.Count);
            _owner.GetComponent<BoxCollider>().enabled = false;
            Assert.IsTrue(Made(Vector3.one) is Sphere);
        }

        [Test]
        public void AClosedMesh()
        {
            _owner.AddComponent<MeshCollider>().sharedMesh = Shapes.Cube();
            Assert.IsTrue(Made(Vector3.one) is Wire.Mesh);
        }

        [Test]
        public void WhatCannotBeSaysWhy()
        {
            string problem;
            _owner.GetComponents(_colliders);
            Assert.IsNull(ColliderShape.Of(_colliders, Vector3.one, out problem));
            Assert.AreEqual("has no collider that is enabled: add a box, sphere, capsule or mesh", problem);
            _owner.AddComponent<CharacterController>();
            _owner.GetComponents(_colliders);
            Assert.IsNull(ColliderShape.Of(_colliders, Vector3.one, out problem));
            Assert.AreEqual("its CharacterController is no box, sphere, capsule or mesh", problem);
        }

        private ISolid Made(Vector3 scale)
        {
            string problem;
            _owner.GetComponents(_colliders);
            ISolid made = ColliderShape.Of(_colliders, scale, out problem);
            Assert.AreEqual("", problem);
            return made;
        }

        private static void Near(Vec3 expected, Vec3 actual)
        {
            Assert.AreEqual(0.0, (expected - actual).Length, 1e-6);
        }
    }
}
