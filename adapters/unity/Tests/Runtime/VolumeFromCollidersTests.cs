using System.Collections.Generic;
using NUnit.Framework;
using Pacinian.Wire;
using UnityEngine;

namespace Pacinian.Haptics.Tests
{
    public sealed class VolumeFromCollidersTests
    {
        private readonly List<Collider> _colliders = new List<Collider>();
        private GameObject _owner;

        private HapticVolume Volume
        {
            get
            {
                HapticVolume found = _owner.GetComponent<HapticVolume>();
                return found != null ? found : _owner.AddComponent<HapticVolume>();
            }
        }

        [SetUp]
        public void Stand()
        {
            _owner = new GameObject("solid");
        }

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
        public void CollidersOfChildrenArePartOfItWhereTheyAre()
        {
            _owner.transform.position = new Vector3(5f, 1f, 2f);
            _owner.transform.rotation = Quaternion.AngleAxis(70f, Vector3.up);
            Transform child = Child("child");
            child.localPosition = new Vector3(0f, 0.1f, 0.2f);
            child.localRotation = Quaternion.AngleAxis(90f, new Vector3(1f, 0f, 0f));
            child.localScale = new Vector3(2f, 2f, 2f);
            CapsuleCollider capsule = child.gameObject.AddComponent<CapsuleCollider>();
            capsule.radius = 0.01f;
            capsule.height = 0.05f;
            capsule.center = new Vector3(0f, 0.01f, 0f);
            Placed made = (Placed)Made(Vector3.one);
            Near(new Vec3(0.0, 0.22, 0.1), made.Pose.Position);
            Near(new Vec3(0.0, 1.0, 0.0), made.Pose.Rotation.Turn(new Vec3(0.0, 0.0, 1.0)));
            Assert.AreEqual(0.06, ((Capsule)made.Shape).Length, 1e-6);
            _owner.AddComponent<SphereCollider>();
            Assert.AreEqual(2, ((Union)Made(Vector3.one)).Parts.Count);
        }

        [Test]
        public void AChildThatIsAVolumeKeepsItsOwn()
        {
            _owner.AddComponent<SphereCollider>();
            Transform child = Child("child"), below = Child("below");
            child.gameObject.AddComponent<BoxCollider>();
            below.SetParent(child, false);
            below.gameObject.AddComponent<BoxCollider>();
            Assert.AreEqual(3, ((Union)Made(Vector3.one)).Parts.Count);
            child.gameObject.AddComponent<HapticVolume>();
            Assert.IsTrue(Made(Vector3.one) is Sphere);
        }

        [Test]
        public void AClosedMesh()
        {
            _owner.AddComponent<MeshCollider>().sharedMesh = Shapes.Cube();
            Assert.IsTrue(Made(Vector3.one) is HapticMesh);
        }

        [Test]
        public void WhatCannotBeSaysWhy()
        {
            string problem;
            VolumeFromColliders.Collect(Volume, _colliders);
            Assert.IsNull(VolumeFromColliders.Of(_colliders, _owner.transform, out problem));
            Assert.AreEqual("has no collider that is enabled, nor have its children: add a box, sphere, capsule or mesh", problem);
            _owner.AddComponent<CharacterController>();
            VolumeFromColliders.Collect(Volume, _colliders);
            Assert.IsNull(VolumeFromColliders.Of(_colliders, _owner.transform, out problem));
            Assert.AreEqual("its CharacterController is no box, sphere, capsule or mesh", problem);
        }

        private ISolid Made(Vector3 scale)
        {
            string problem;
            _owner.transform.localScale = scale;
            VolumeFromColliders.Collect(Volume, _colliders);
            ISolid made = VolumeFromColliders.Of(_colliders, _owner.transform, out problem);
            Assert.AreEqual("", problem);
            return made;
        }

        private Transform Child(string name)
        {
            GameObject made = new GameObject(name);
            made.transform.SetParent(_owner.transform, false);
            return made.transform;
        }

        private static void Near(Vec3 expected, Vec3 actual)
        {
            Assert.AreEqual(0.0, (expected - actual).Length, 1e-6);
        }
    }
}
