using Pacinian.Wire;
using UnityEngine;

namespace Pacinian.Haptics
{
    /// <summary>An open hand in place of a tracked one: its palm is at a transform and faces down, its fingers point forward.</summary>
    internal static class OpenHand
    {
        private static readonly float[] Right = // right, up, forward of each joint [mm]
        {
            0, 0, 0, 0, 0, -60, -22, -6, -44, -52, -14, -14, -74, -17, 8, -88, -18, 25,
            -14, 0, -32, -22.5f, 0, 31, -27.5f, 0, 71.7f, -30.4f, 0, 95.5f, -32.6f, 0, 113.4f,
            0, 0, -32, 0, 0, 32, 0, 0, 77, 0, 0, 105, 0, 0, 124,
            12, 0, -31, 20.5f, 0, 27, 25.6f, 0, 68.7f, 28.9f, 0, 95.5f, 31.2f, 0, 114.3f,
            22, 0, -28, 38.5f, 0, 17, 47.6f, 0, 48.7f, 52.8f, 0, 67, 57.5f, 0, 83.3f,
        };

        private static readonly float[] Radii = // [mm]
        {
            20, 21, 19, 12.5f, 10, 8.5f, 20, 10.5f, 8.5f, 7.5f, 6.5f, 20, 11, 8.5f, 7.5f, 6.5f, 19, 10, 8, 7.5f, 6.5f, 18,
            8.5f, 7, 6.5f, 5.5f,
        };

        /// <summary>Writes its joints [m], in the world, and radii [m].</summary>
        public static bool Write(Transform at, HandFrameSide side, Vector3[] positions, float[] radii)
        {
            float mirror = side == HandFrameSide.Left ? -0.001f : 0.001f;
            Vector3 palm = at.position;
            Quaternion turned = at.rotation;
            for (int i = 0; i < HapticHand.Count; i++)
            {
                Vector3 joint = new Vector3(mirror * Right[3 * i], 0.001f * Right[3 * i + 1], 0.001f * Right[3 * i + 2]);
                positions[i] = palm + turned * joint;
                radii[i] = 0.001f * Radii[i];
            }
            return true;
        }
    }
}
