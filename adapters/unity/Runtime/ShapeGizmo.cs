using System;
using Pacinian.Wire;
using UnityEngine;

namespace Pacinian.Haptics
{
    /// <summary>Draws the wire's shapes with gizmos.</summary>
    internal static class ShapeGizmo
    {
        private const int Segments = 32, MostFaces = 3000; // of a circle; of a mesh, beyond which some faces are left out

        /// <summary>Draws an object at its pose in the world.</summary>
        public static void Draw(HapticObject felt, Rigid frame)
        {
            Point point = felt as Point;
            Surface surface = felt as Surface;
            Volume volume = felt as Volume;
            Place(frame);
            if (point != null)
            {
                Gizmos.DrawWireSphere(Vector3.zero, (float)Math.Sqrt(point.Area / Math.PI));
            }
            if (surface != null)
            {
                One(surface.Shape);
            }
            Union all = volume == null ? null : volume.Shape as Union;
            for (int i = 0; all != null && i < all.Parts.Count; i++)
            {
                Piece(all.Parts[i], frame);
            }
            if (volume != null && all == null)
            {
                Piece(volume.Shape, frame);
            }
        }

        private static void Piece(IMessage shape, Rigid frame)
        {
            Placed placed = shape as Placed;
            Place(placed == null ? frame : frame * new Rigid(placed.Pose.Position, placed.Pose.Rotation));
            One(placed == null ? shape : placed.Shape);
        }

        private static void Place(Rigid frame)
        {
            Gizmos.matrix = Matrix4x4.TRS(WireSpace.ToUnity(frame.Position), WireSpace.ToUnity(frame.Rotation), Vector3.one);
        }

        private static void One(IMessage shape)
        {
            Box box = shape as Box;
            Sphere sphere = shape as Sphere;
            Capsule capsule = shape as Capsule;
            Rectangle rectangle = shape as Rectangle;
            Disc disc = shape as Disc;
            HapticMesh mesh = shape as HapticMesh;
            if (box != null)
            {
                Gizmos.DrawWireCube(Vector3.zero, WireSpace.ToUnity(box.Size));
            }
            if (sphere != null)
            {
                Gizmos.DrawWireSphere(Vector3.zero, (float)sphere.Radius);
            }
            if (capsule != null)
            {
                Long((float)capsule.Radius, 0.5f * (float)capsule.Length);
            }
            if (rectangle != null)
            {
                Gizmos.DrawWireCube(Vector3.zero, new Vector3((float)rectangle.Width, 0f, (float)rectangle.Height));
            }
            if (disc != null)
            {
                Circle((float)disc.Radius);
            }
            if (mesh != null)
            {
                Faces(mesh);
            }
        }

        private static void Long(float radius, float half)
        {
            Vector3 end = half * Vector3.up;
            Gizmos.DrawWireSphere(end, radius);
            Gizmos.DrawWireSphere(-1f * end, radius);
            for (int i = 0; i < 4; i++)
            {
                Vector3 side = Around(i / 4f, radius);
                Gizmos.DrawLine(side + end, side - end);
            }
        }

        private static void Circle(float radius)
        {
            for (int i = 0; i < Segments; i++)
            {
                Gizmos.DrawLine(Around(i / (float)Segments, radius), Around((i + 1) / (float)Segments, radius));
            }
        }

        private static Vector3 Around(float turn, float radius)
        {
            return new Vector3(radius * Mathf.Cos(2f * Mathf.PI * turn), 0f, radius * Mathf.Sin(2f * Mathf.PI * turn));
        }

        private static void Faces(HapticMesh mesh)
        {
            int count = mesh.Faces.Numbers / 3;
            for (int i = 0; i < count; i += 1 + count / MostFaces)
            {
                Vector3 a = Corner(mesh, 3 * i), b = Corner(mesh, 3 * i + 1), c = Corner(mesh, 3 * i + 2);
                Gizmos.DrawLine(a, b);
                Gizmos.DrawLine(b, c);
                Gizmos.DrawLine(c, a);
            }
        }

        private static Vector3 Corner(HapticMesh mesh, int index)
        {
            return WireSpace.ToUnity(mesh.Vertices.Point((int)mesh.Faces.Index(index)));
        }
    }
}
