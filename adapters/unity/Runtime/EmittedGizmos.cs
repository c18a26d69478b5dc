using UnityEngine;

namespace Pacinian.Haptics
{
    /// <summary>What the server says that it emits: each sample where it is, as strong as it was achieved.</summary>
    internal static class EmittedGizmos
    {
        private const float Strong = 20f; // [Pa] that is drawn in full red

        /// <summary>Draws the samples of a state. array: its frame in the world.</summary>
        public static void Draw(Wire.State state, Rigid array)
        {
            int count = Count(state);
            for (int i = 0; i < count; i++)
            {
                float achieved = state.Achieved.Single(i);
                Vector3 place = Frames.Back(array.Point(state.Points.Point(i)));
                Gizmos.color = Color.Lerp(Color.yellow, Color.red, achieved / Strong);
                Gizmos.DrawSphere(place, 0.001f + 0.003f * Mathf.Clamp01(achieved / Strong));
                Gizmos.DrawLine(place, place + Frames.Back(array.Direction((0.001 * achieved) * state.Normals.Point(i))));
            }
        }

        /// <summary>The largest radiation pressure that is emitted for an object [Pa]; 0 if none is.</summary>
        public static float Most(Wire.State state, string name)
        {
            int count = Count(state);
            float most = 0f;
            for (int i = 0; i < count; i++)
            {
                int index = (int)state.Index.Index(i);
                bool own = index >= 0 && index < state.Objects.Count && state.Objects[index] == name;
                most = own ? Mathf.Max(most, state.Achieved.Single(i)) : most;
            }
            return most;
        }

        /// <summary>Samples; none where it does not sound.</summary>
        private static int Count(Wire.State state)
        {
            int count = state.Points.Numbers / 3;
            bool whole = state.Achieved.Numbers == count && state.Normals.Numbers == 3 * count && state.Index.Numbers == count;
            return whole && state.Output == Wire.Output.Sounding ? count : 0;
        }
    }
}
