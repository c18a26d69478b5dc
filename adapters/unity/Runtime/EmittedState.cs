using UnityEngine;

namespace Pacinian.Haptics
{
    /// <summary>What the server reports that it emits: the position and the achieved pressure of each sample.</summary>
    internal static class EmittedState
    {
        private const double Old = 0.5; // [s]; an older state is not shown

        /// <summary>The present state; null if there is none, or if it is too old.</summary>
        public static Wire.State Now
        {
            get
            {
                HapticServer server = HapticServer.Current;
                HapticClient client = server == null ? null : server.Client;
                Wire.State state = client == null ? null : client.State;
                return state != null && client.Age(state) < Old ? state : null;
            }
        }

        /// <summary>Returns the largest radiation pressure emitted for an object [Pa]; 0 if there is none.</summary>
        public static float Most(Wire.State state, string name)
        {
            int count = state == null ? 0 : Count(state);
            float most = 0f;
            for (int i = 0; i < count; i++)
            {
                int index = (int)state.Index.Index(i);
                bool own = index >= 0 && index < state.Objects.Count && state.Objects[index] == name;
                most = own ? Mathf.Max(most, state.Achieved.Single(i)) : most;
            }
            return most;
        }

        /// <summary>Returns the number of samples; 0 unless the output sounds.</summary>
        public static int Count(Wire.State state)
        {
            int count = state.Points.Numbers / 3;
            bool whole = state.Achieved.Numbers == count && state.Asked.Numbers == count
                && state.Normals.Numbers == 3 * count && state.Index.Numbers == count;
            return whole && state.Output == Wire.Output.Sounding ? count : 0;
        }
    }
}
