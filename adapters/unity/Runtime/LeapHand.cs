using System.Collections.Generic;
using UnityEngine;

namespace Pacinian.Haptics
{
    /// <summary>Converts a hand of Ultraleap's trackers to 26 joints in OpenXR's order.</summary>
    internal static class LeapHand
    {
        /// <summary>The number of fingers, and of bones of each: metacarpal, proximal, intermediate, distal.</summary>
        public const int Digits = 5, Bones = 4;

        private const int Palm = 0, Wrist = 1, Thumb = 2, MiddleMetacarpal = 11; // joints

        /// <summary>
        /// Writes the joints and radii. bones: both ends of 20 bones; widths: of these. The thumb's metacarpal is not
        /// used, because it has no length. The palm is the middle of the middle finger's metacarpal, as in OpenXR.
        /// Returns false if a count differs.
        /// </summary>
        public static bool Write(IList<Vector3> bones, IList<float> widths, Vector3 wrist, Vector3[] positions, float[] radii)
        {
            bool whole = bones.Count == 2 * Digits * Bones && widths.Count == Digits * Bones;
            int joint = Thumb;
            for (int digit = 0; digit < Digits && whole; digit++)
            {
                int first = (digit * Bones) + (digit == 0 ? 1 : 0), last = (digit + 1) * Bones;
                for (int bone = first; bone <= last; bone++, joint++)
                {
                    positions[joint] = bone < last ? bones[2 * bone] : bones[(2 * bone) - 1];
                    float before = widths[bone > first ? bone - 1 : first], after = widths[bone < last ? bone : last - 1];
                    radii[joint] = 0.25f * (before + after);
                }
            }
            positions[Wrist] = wrist;
            radii[Wrist] = (float)OpenHand.Radius(Wrist); // an adult's: Ultraleap reports only the width of the forearm
            positions[Palm] = 0.5f * (positions[MiddleMetacarpal] + positions[MiddleMetacarpal + 1]);
            radii[Palm] = radii[MiddleMetacarpal];
            return whole;
        }
    }
}
