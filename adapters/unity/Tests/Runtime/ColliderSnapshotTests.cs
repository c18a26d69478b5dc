using System;
using System.Collections.Generic;
using NUnit.Framework;
using UnityEngine;

namespace Pacinian.Haptics.Tests
{
    public sealed class ColliderSnapshotTests
    {
        private GameObject _owner;

        [SetUp]
        public void Stand()
        {
            _owner = new GameObject("solid");
            _owner.AddComponent<HapticVolume>();
        }

        [TearDown]
        public void Clean()
        {
            UnityEngine.Object.DestroyImmediate(_owner);
        }

        [Test]
        public void AChangeOfAColliderIsNoticedAndAMoveOfTheWholeIsNone()
        {
            SphereCollider sphere = _owner.AddComponent<SphereCollider>();
            Transform child = new GameObject("child").transform;
            child.SetParent(_owner.transform, false);
            ColliderSnapshot known = Snapshot();
            _owner.transform.position = new Vector3(1f, 2f, 3f);
            _owner.transform.rotation = Quaternion.AngleAxis(10f, Vector3.up);
            Assert.IsTrue(known.Matches(Snapshot()), "the whole moves");
            Changes(() => sphere.radius = 0.4f);
            Changes(() => sphere.radius = 0.4f + 3e-8f);
            Changes(() => sphere.center = new Vector3(0f, 0.1f, 0f));
            Changes(() => sphere.center = new Vector3(0.1f, 0f, 0f));
            Changes(() => sphere.enabled = false);
            Changes(() => sphere.enabled = true);
            Changes(() => child.gameObject.AddComponent<BoxCollider>());
            Changes(() => child.localPosition = new Vector3(0f, 0.02f, 0f));
            Changes(() => child.localRotation = Quaternion.AngleAxis(5f, Vector3.up));
            Changes(() => child.localScale = new Vector3(1f, 1f, 2f));
            Changes(() => child.gameObject.AddComponent<MeshCollider>());
            Changes(() => child.GetComponent<MeshCollider>().sharedMesh = Shapes.Cube());
            Changes(() => child.GetComponent<MeshCollider>().sharedMesh = Shapes.Cube());
            Changes(() => child.gameObject.SetActive(false));
        }

        private ColliderSnapshot Snapshot()
        {
            ColliderSnapshot made = new ColliderSnapshot();
            List<Collider> colliders = new List<Collider>();
            VolumeFromColliders.Collect(_owner.GetComponent<HapticVolume>(), colliders);
            made.Take(colliders, _owner.transform);
            return made;
        }

        private void Changes(Action change)
        {
            ColliderSnapshot before = Snapshot();
            change();
            Assert.IsFalse(before.Matches(Snapshot()));
        }
    }
}
