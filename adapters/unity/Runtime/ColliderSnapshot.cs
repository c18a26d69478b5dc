using System.Collections.Generic;
using UnityEngine;

namespace Pacinian.Haptics
{
    /// <summary>
    /// All values of colliders on which the solid made of them depends. Two snapshots of the same colliders differ if one is
    /// added, removed, enabled, disabled, resized, or moved within its object, but not if the whole object moves.
    /// </summary>
    internal sealed class ColliderSnapshot
    {
        private readonly List<object> _objects = new List<object>(); // the colliders, each with its mesh
        private readonly List<float> _values = new List<float>();

        /// <summary>Stores the values of colliders, relative to their root. Allocates nothing once the lists have grown.</summary>
        public void Take(List<Collider> colliders, Transform root)
        {
            _objects.Clear();
            _values.Clear();
            for (int i = 0; i < colliders.Count; i++)
            {
                _objects.Add(colliders[i]);
                _values.Add(colliders[i].enabled ? 1f : 0f);
                AddShape(colliders[i]);
                for (Transform at = colliders[i].transform; at != root && at != null; at = at.parent)
                {
                    Quaternion turn = at.localRotation;
                    Add(at.localPosition);
                    Add(new Vector3(turn.x, turn.y, turn.z));
                    _values.Add(turn.w);
                    Add(at.localScale);
                }
            }
        }

        /// <summary>Returns whether all values are those of another snapshot.</summary>
        public bool Matches(ColliderSnapshot other)
        {
            bool same = _objects.Count == other._objects.Count && _values.Count == other._values.Count;
            for (int i = 0; same && i < _objects.Count; i++)
            {
                same = ReferenceEquals(_objects[i], other._objects[i]);
            }
            for (int i = 0; same && i < _values.Count; i++)
            {
                same = _values[i].Equals(other._values[i]); // equal also if both are NaN
            }
            return same;
        }

        private void AddShape(Collider collider)
        {
            BoxCollider box = collider as BoxCollider;
            SphereCollider sphere = collider as SphereCollider;
            CapsuleCollider capsule = collider as CapsuleCollider;
            MeshCollider mesh = collider as MeshCollider;
            if (box != null)
            {
                Add(box.size);
                Add(box.center);
            }
            if (sphere != null)
            {
                _values.Add(sphere.radius);
                Add(sphere.center);
            }
            if (capsule != null)
            {
                Add(new Vector3(capsule.radius, capsule.height, capsule.direction));
                Add(capsule.center);
            }
            if (mesh != null)
            {
                _objects.Add(mesh.sharedMesh);
            }
        }

        private void Add(Vector3 value)
        {
            _values.Add(value.x);
            _values.Add(value.y);
            _values.Add(value.z);
        }
    }
}
