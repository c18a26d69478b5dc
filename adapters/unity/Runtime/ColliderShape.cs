using System;
using System.Collections.Generic;
using Pacinian.Wire;
using UnityEngine;

namespace Pacinian.Haptics
{
    /// <summary>Colliders of one object as a solid, scaled, in the wire's axes.</summary>
    internal static class ColliderShape
    {
        /// <summary>One, or the union of them all; null, and why, if that cannot be.</summary>
        public static ISolid Of(List<Collider> colliders, Vector3 scale, out string problem)
        {
            Union all = new Union();
            problem = "";
            foreach (Collider collider in colliders)
            {
                IPiece piece = collider.enabled ? One(collider, scale, out problem) : null;
                if (problem.Length > 0)
                {
                    return null;
                }
                if (piece != null)
                {
                    all.Parts.Add(piece);
                }
            }
            problem = all.Parts.Count == 0 ? "has no collider that is enabled: add a box, sphere, capsule or mesh"
                : all.Parts.Count > Protocol.MaxParts ? "has more than " + Protocol.MaxParts + " colliders"
                : "";
            return problem.Length > 0 ? null : all.Parts.Count > 1 ? all : (ISolid)all.Parts[0];
        }

        private static IPiece One(Collider collider, Vector3 scale, out string problem)
        {
            problem = "";
            Vector3 size = new Vector3(Math.Abs(scale.x), Math.Abs(scale.y), Math.Abs(scale.z));
            BoxCollider box = collider as BoxCollider;
            SphereCollider sphere = collider as SphereCollider;
            CapsuleCollider capsule = collider as CapsuleCollider;
            MeshCollider mesh = collider as MeshCollider;
            if (box != null)
            {
                return Placed(new Box { Size = Frames.Of(Vector3.Scale(box.size, size)) }, Vector3.Scale(box.center, scale));
            }
            if (sphere != null)
            {
                double radius = sphere.radius * Math.Max(size.x, Math.Max(size.y, size.z));
                return Placed(new Sphere { Radius = radius }, Vector3.Scale(sphere.center, scale));
            }
            if (capsule != null)
            {
                return Capsule(capsule, size, Vector3.Scale(capsule.center, scale));
            }
            problem = mesh == null ? "its " + collider.GetType().Name + " is no box, sphere, capsule or mesh" : "";
            return mesh == null ? null : MeshShape.Of(mesh.sharedMesh, scale, out problem);
        }

        /// <summary>Along Unity's y, which is the wire's z, a capsule is as the wire has it.</summary>
        private static IPiece Capsule(CapsuleCollider capsule, Vector3 size, Vector3 centre)
        {
            int axis = capsule.direction;
            double radius = capsule.radius * Math.Max(size[(axis + 1) % 3], size[(axis + 2) % 3]);
            double length = capsule.height * size[axis] - 2.0 * radius;
            if (length < 1e-6)
            {
                return Placed(new Sphere { Radius = radius }, centre);
            }
            Capsule made = new Capsule { Radius = radius, Length = length };
            return axis == 1 ? Placed(made, centre) : new Placed { Shape = made, Pose = Turned(centre, axis) };
        }

        private static Wire.Pose Turned(Vector3 centre, int axis)
        {
            double half = Math.Sqrt(0.5);
            Quat turn = axis == 0 ? new Quat(0.0, half, 0.0, half) : new Quat(-half, 0.0, 0.0, half);
            return new Wire.Pose { Position = Frames.Of(centre), Rotation = turn };
        }

        private static IPiece Placed<T>(T shape, Vector3 centre)
            where T : IPrimitive, IPiece
        {
            bool there = centre.x == 0f && centre.y == 0f && centre.z == 0f;
            return there ? (IPiece)shape
                : new Placed { Shape = shape, Pose = new Wire.Pose { Position = Frames.Of(centre) } };
        }
    }
}
