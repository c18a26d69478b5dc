using UnityEngine;

namespace Pacinian.Haptics.Tests
{
    /// <summary>Makes meshes in Unity's form.</summary>
    internal static class Shapes
    {
        private static readonly Vector3[] Normals =
        {
            new Vector3(1f, 0f, 0f), new Vector3(-1f, 0f, 0f), new Vector3(0f, 1f, 0f), new Vector3(0f, -1f, 0f),
            new Vector3(0f, 0f, 1f), new Vector3(0f, 0f, -1f),
        };

        /// <summary>Returns a cube of side 1 with four vertices on each side, clockwise from outside, in left-handed axes.</summary>
        public static Mesh Cube()
        {
            Vector3[] vertices = new Vector3[24];
            int[] triangles = new int[36];
            for (int side = 0; side < 6; side++)
            {
                Vector3 n = Normals[side], u = new Vector3(n.y, n.z, n.x), v = Cross(n, u);
                for (int i = 0; i < 4; i++)
                {
                    float a = i == 0 || i == 3 ? -1f : 1f, b = i < 2 ? -1f : 1f;
                    vertices[4 * side + i] = 0.5f * (n + a * u + b * v);
                }
                int[] order = { 0, 1, 2, 0, 2, 3 };
                for (int i = 0; i < 6; i++)
                {
                    triangles[6 * side + i] = 4 * side + order[i];
                }
            }
            return new Mesh { vertices = vertices, triangles = triangles };
        }

        /// <summary>Returns a square of side 1 in x and z, clockwise from above, in left-handed axes.</summary>
        public static Mesh Square()
        {
            return new Mesh
            {
                vertices = new[]
                {
                    new Vector3(-0.5f, 0f, -0.5f), new Vector3(-0.5f, 0f, 0.5f), new Vector3(0.5f, 0f, 0.5f), new Vector3(0.5f, 0f, -0.5f),
                },
                triangles = new[] { 0, 1, 2, 0, 2, 3 },
            };
        }

        private static Vector3 Cross(Vector3 a, Vector3 b)
        {
            return new Vector3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
        }
    }
}
