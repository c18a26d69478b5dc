using System.Collections.Generic;
using UnityEngine;

namespace Pacinian.Haptics
{
    /// <summary>Converts a mesh to the wire's.</summary>
    internal static class MeshShape
    {
        /// <summary>
        /// Returns the triangles of a mesh, scaled, in the wire's axes; null and the reason on failure. Vertices at the
        /// same position are merged: Unity splits them at texture seams and edges, but a volume must be closed.
        /// </summary>
        public static Wire.HapticMesh Of(Mesh mesh, Vector3 scale, out string problem)
        {
            problem = mesh == null ? "has no mesh"
                : !mesh.isReadable ? "its mesh cannot be read: switch on Read/Write in its import settings"
                : "";
            if (problem.Length > 0)
            {
                return null;
            }
            Wire.HapticMesh made = new Wire.HapticMesh();
            int[] index = Weld(mesh.vertices, scale, made);
            bool mirrored = scale.x * scale.y * scale.z < 0f;
            int faces = Faces(mesh.triangles, index, mirrored, made);
            problem = faces == 0 ? "its mesh has no triangles"
                : faces > Wire.Protocol.MaxFaces ? "its mesh has " + faces + " triangles: keep to " + Wire.Protocol.MaxFaces
                : "";
            return problem.Length > 0 ? null : made;
        }

        /// <summary>Returns the given mesh, otherwise that of the MeshFilter on the same object; null if it has none.</summary>
        public static Mesh Near(Component component, Mesh given)
        {
            MeshFilter filter = given == null ? component.GetComponent<MeshFilter>() : null;
            return filter == null ? given : filter.sharedMesh;
        }

        private static int[] Weld(Vector3[] vertices, Vector3 scale, Wire.HapticMesh made)
        {
            Dictionary<Vector3, int> known = new Dictionary<Vector3, int>();
            int[] index = new int[vertices.Length];
            for (int i = 0; i < vertices.Length; i++)
            {
                Vector3 vertex = Vector3.Scale(vertices[i], scale);
                if (!known.TryGetValue(vertex, out index[i]))
                {
                    index[i] = known.Count;
                    known.Add(vertex, index[i]);
                    made.Vertices.Add(WireSpace.ToWire(vertex));
                }
            }
            return index;
        }

        /// <summary>
        /// Writes the faces. Unity's front faces are clockwise, the wire's counter-clockwise; a mirrored scale reverses
        /// that.
        /// </summary>
        private static int Faces(int[] triangles, int[] index, bool mirrored, Wire.HapticMesh made)
        {
            int faces = 0;
            for (int i = 0; i + 2 < triangles.Length; i += 3)
            {
                int a = index[triangles[i]], b = index[triangles[i + 1]], c = index[triangles[i + 2]];
                if (a == b || b == c || c == a)
                {
                    continue;
                }
                made.Faces.Add((uint)a);
                made.Faces.Add((uint)(mirrored ? b : c));
                made.Faces.Add((uint)(mirrored ? c : b));
                faces++;
            }
            return faces;
        }
    }
}
