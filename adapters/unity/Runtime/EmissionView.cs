using System.Collections.Generic;
using UnityEngine;

namespace Pacinian.Haptics
{
    /// <summary>Draws, with gizmos, what the server reports that it emits, which may differ from what the game requested.</summary>
    [AddComponentMenu("Pacinian/Emission View")]
    public sealed class EmissionView : MonoBehaviour
    {
        private const float Arrow = 0.02f; // [m]

        [SerializeField, Tooltip("Draw the points under pressure: blue is weak, red is the strongest requested pressure.")]
        private bool drawSamples = true;
        [SerializeField, Tooltip("Draw the normals of the surface at these points.")]
        private bool drawNormals;
        [SerializeField, Tooltip("Draw the hands as the server renders them.")]
        private bool drawHands = true;

        /// <summary>Whether to draw the points under pressure: blue is weak, red is the strongest requested pressure.</summary>
        public bool DrawSamples
        {
            get { return drawSamples; }
            set { drawSamples = value; }
        }

        /// <summary>Whether to draw the normals of the surface at these points.</summary>
        public bool DrawNormals
        {
            get { return drawNormals; }
            set { drawNormals = value; }
        }

        /// <summary>Whether to draw the hands as the server renders them.</summary>
        public bool DrawHands
        {
            get { return drawHands; }
            set { drawHands = value; }
        }

        /// <summary>Replaces the lists' contents by the points under pressure, in the world [m], and their pressures [Pa].</summary>
        public void GetSamples(List<Vector3> positions, List<float> pressures)
        {
            positions.Clear();
            pressures.Clear();
            Wire.State state = EmittedState.Now;
            Rigid array = ArrayOrigin.InWorld;
            for (int i = 0; state != null && i < EmittedState.Count(state); i++)
            {
                positions.Add(WireSpace.ToUnity(array.Point(state.Points.Point(i))));
                pressures.Add(state.Achieved.Single(i));
            }
        }

        private void OnDrawGizmos()
        {
            Wire.State state = EmittedState.Now;
            if (state == null)
            {
                return;
            }
            Samples(state, ArrayOrigin.InWorld);
            for (int i = 0; drawHands && i < state.Hands.Numbers / 3; i++)
            {
                Vec3 place = state.Hands.Point(i);
                if (WireSpace.IsInRange(place))
                {
                    Gizmos.color = Color.white;
                    Gizmos.DrawWireSphere(WireSpace.ToUnity(ArrayOrigin.InWorld.Point(place)), i % HapticHand.Count == 0 ? 0.004f : 0.002f);
                }
            }
        }

        private void Samples(Wire.State state, Rigid array)
        {
            int count = EmittedState.Count(state);
            float strongest = 1e-6f;
            for (int i = 0; i < count; i++)
            {
                strongest = Mathf.Max(strongest, state.Asked.Single(i));
            }
            for (int i = 0; i < count; i++)
            {
                float share = Mathf.Clamp01(state.Achieved.Single(i) / strongest);
                Vector3 place = WireSpace.ToUnity(array.Point(state.Points.Point(i)));
                Gizmos.color = Color.Lerp(Color.blue, Color.red, share);
                if (drawSamples)
                {
                    Gizmos.DrawSphere(place, 0.001f + 0.003f * share);
                }
                if (drawNormals)
                {
                    Gizmos.DrawLine(place, place + Arrow * WireSpace.ToUnity(array.Direction(state.Normals.Point(i))));
                }
            }
        }
    }
}
