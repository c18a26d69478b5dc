using System.Collections.Generic;
using UnityEngine;

namespace Pacinian.Haptics
{
    /// <summary>Draws what the server says that it emits, not what the game asked for, by gizmos.</summary>
    [AddComponentMenu("Pacinian/Emission View")]
    public sealed class EmissionView : MonoBehaviour
    {
        private const float Arrow = 0.02f; // [m]

        [SerializeField, Tooltip("The points that are pressed on: blue is weak, red as strong as the strongest asked for.")]
        private bool drawSamples = true;
        [SerializeField, Tooltip("Which way their surface faces.")]
        private bool drawNormals;
        [SerializeField, Tooltip("The hands as they are rendered.")]
        private bool drawHands = true;

        /// <summary>The points that are pressed on: blue is weak, red as strong as the strongest asked for.</summary>
        public bool DrawSamples
        {
            get { return drawSamples; }
            set { drawSamples = value; }
        }

        /// <summary>Which way their surface faces.</summary>
        public bool DrawNormals
        {
            get { return drawNormals; }
            set { drawNormals = value; }
        }

        /// <summary>The hands as they are rendered.</summary>
        public bool DrawHands
        {
            get { return drawHands; }
            set { drawHands = value; }
        }

        /// <summary>The points that are pressed on now, in the world [m], and how hard [Pa], in place of what the lists have.</summary>
        public void GetSamples(List<Vector3> positions, List<float> pressures)
        {
            positions.Clear();
            pressures.Clear();
            Wire.State state = Emitted.Now;
            Rigid array = ArrayOrigin.InWorld;
            for (int i = 0; state != null && i < Emitted.Count(state); i++)
            {
                positions.Add(Frames.Back(array.Point(state.Points.Point(i))));
                pressures.Add(state.Achieved.Single(i));
            }
        }

        private void OnDrawGizmos()
        {
            Wire.State state = Emitted.Now;
            if (state == null)
            {
                return;
            }
            Samples(state, ArrayOrigin.InWorld);
            for (int i = 0; drawHands && i < state.Hands.Numbers / 3; i++)
            {
                Vec3 place = state.Hands.Point(i);
                if (Frames.InReach(place))
                {
                    Gizmos.color = Color.white;
                    Gizmos.DrawWireSphere(Frames.Back(ArrayOrigin.InWorld.Point(place)), i % HapticHand.Count == 0 ? 0.004f : 0.002f);
                }
            }
        }

        private void Samples(Wire.State state, Rigid array)
        {
            int count = Emitted.Count(state);
            float strongest = 1e-6f;
            for (int i = 0; i < count; i++)
            {
                strongest = Mathf.Max(strongest, state.Asked.Single(i));
            }
            for (int i = 0; i < count; i++)
            {
                float share = Mathf.Clamp01(state.Achieved.Single(i) / strongest);
                Vector3 place = Frames.Back(array.Point(state.Points.Point(i)));
                Gizmos.color = Color.Lerp(Color.blue, Color.red, share);
                if (drawSamples)
                {
                    Gizmos.DrawSphere(place, 0.001f + 0.003f * share);
                }
                if (drawNormals)
                {
                    Gizmos.DrawLine(place, place + Arrow * Frames.Back(array.Direction(state.Normals.Point(i))));
                }
            }
        }
    }
}
