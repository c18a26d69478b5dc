using System;
using System.Collections.Generic;
using Pacinian.Wire;
using UnityEngine;

namespace Pacinian.Haptics
{
    /// <summary>
    /// Converts the colliders of an object and of its children to one scaled solid, in the object's frame and the
    /// wire's axes.
    /// </summary>
    internal static class VolumeFromColliders
    {
        /// <summary>
        /// Collects the colliders of an object and of its children, except those of a child that has its own Haptic
        /// Volume.
        /// </summary>
        public static void Collect(HapticVolume owner, List<Collider> found)
        {
            owner.GetComponentsInChildren(found);
            for (int i = found.Count - 1; i >= 0; i--)
            {
                if (IsOfOther(found[i].transform, owner.transform))
                {
                    found.RemoveAt(i);
                }
            }
        }

        /// <summary>
        /// Returns the collider, or the union of several; null and the reason on failure. root: the result is in its
        /// frame.
        /// </summary>
        public static ISolid Of(List<Collider> colliders, Transform root, out string problem)
        {
            Union all = new Union();
            problem = "";
            foreach (Collider collider in colliders)
            {
                IPiece piece = collider.enabled ? One(collider, root, out problem) : null;
                if (problem.Length > 0)
                {
                    return null;
                }
                if (piece != null)
                {
                    all.Parts.Add(piece);
                }
            }
            problem = all.Parts.Count == 0
                ? "has no collider that is enabled, nor have its children: add a box, sphere, capsule or mesh"
                : all.Parts.Count > Protocol.MaxParts ? "has more than " + Protocol.MaxParts + " colliders, with those of its children"
                : "";
            return problem.Length > 0 ? null : all.Parts.Count > 1 ? all : (ISolid)all.Parts[0];
        }

        private static bool IsOfOther(Transform at, Transform root)
        {
            HapticVolume other;
            return at != root && at != null && (at.TryGetComponent(out other) || IsOfOther(at.parent, root));
        }

        private static IPiece One(Collider collider, Transform root, out string problem)
        {
            problem = "";
            Vector3 scale = collider.transform.lossyScale;
            Vector3 size = new Vector3(Math.Abs(scale.x), Math.Abs(scale.y), Math.Abs(scale.z));
            BoxCollider box = collider as BoxCollider;
            SphereCollider sphere = collider as SphereCollider;
            CapsuleCollider capsule = collider as CapsuleCollider;
            MeshCollider mesh = collider as MeshCollider;
            if (box != null)
            {
                return Placed(new Box { Size = WireSpace.ToWire(Vector3.Scale(box.size, size)) }, box, box.center, root, Quat.Identity);
            }
            if (sphere != null)
            {
                double radius = sphere.radius * Math.Max(size.x, Math.Max(size.y, size.z));
                return Placed(new Sphere { Radius = radius }, sphere, sphere.center, root, Quat.Identity);
            }
            if (capsule != null)
            {
                return Capsule(capsule, size, root);
            }
            HapticMesh made = null;
            problem = mesh == null ? "its " + collider.GetType().Name + " is no box, sphere, capsule or mesh" : "";
            if (mesh != null)
            {
                made = MeshShape.Of(mesh.sharedMesh, scale, out problem);
            }
            return made == null ? null : Placed(made, mesh, Vector3.zero, root, Quat.Identity);
        }

        /// <summary>A capsule needs no turn if its axis is Unity's y, which is the wire's z.</summary>
        private static IPiece Capsule(CapsuleCollider capsule, Vector3 size, Transform root)
        {
            int axis = capsule.direction;
            double radius = capsule.radius * Math.Max(size[(axis + 1) % 3], size[(axis + 2) % 3]);
            double length = capsule.height * size[axis] - 2.0 * radius, half = Math.Sqrt(0.5);
            if (length < 1e-6)
            {
                return Placed(new Sphere { Radius = radius }, capsule, capsule.center, root, Quat.Identity);
            }
            Quat turn = axis == 0 ? new Quat(0.0, half, 0.0, half) : axis == 1 ? Quat.Identity : new Quat(-half, 0.0, 0.0, half);
            return Placed(new Capsule { Radius = radius, Length = length }, capsule, capsule.center, root, turn);
        }

        /// <summary>Returns the shape, turned and then placed like its collider, in the root's frame.</summary>
        private static IPiece Placed<T>(T shape, Collider collider, Vector3 centre, Transform root, Quat turn)
            where T : IPrimitive, IPiece
        {
            Transform at = collider.transform;
            Vector3 place = Vector3.Scale(centre, at.lossyScale);
            if (at != root)
            {
                Rigid placed = new Rigid(WireSpace.ToWire(at.TransformPoint(centre)), WireSpace.ToWire(at.rotation));
                Rigid inside = WireSpace.ToWire(root).Inverse * placed;
                return Place(shape, inside.Position, inside.Rotation * turn);
            }
            bool still = place.x == 0f && place.y == 0f && place.z == 0f && turn.W == 1.0;
            return still ? (IPiece)shape : Place(shape, WireSpace.ToWire(place), turn);
        }

        private static Placed Place(IPrimitive shape, Vec3 position, Quat rotation)
        {
            return new Placed { Shape = shape, Pose = new HapticPose { Position = position, Rotation = rotation } };
        }
    }
}
