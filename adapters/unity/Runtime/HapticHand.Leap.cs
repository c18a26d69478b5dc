using System.Collections.Generic;
using UnityEngine;

namespace Pacinian.Haptics
{
    /// <summary>Hands as Ultraleap's trackers tell them.</summary>
    public sealed partial class HapticHand
    {
        private const int Digits = 5, Bones = 4; // metacarpal, proximal, intermediate, distal
        private const int Palm = 0, Wrist = 1, Thumb = 2, MiddleMetacarpal = 11; // joints
        private const float WristRadius = 0.021f; // [m] of an adult: Ultraleap tells only the width of the forearm

        /// <summary>
        /// Of source Game, in place of SetJoints and SetRadii: a hand as Ultraleap tells it, in the world [m]. bones: both ends
        /// (prev and next joint) of the four bones of the five digits from the thumb on: 40. widths: of the 20 bones. wrist: the
        /// arm's next joint. The thumb's metacarpal is not used, as it has no length; the palm is the middle of the middle
        /// finger's metacarpal, as in OpenXR. Fewer or more bones or widths: it is lost.
        /// </summary>
        public void SetLeap(IList<Vector3> bones, IList<float> widths, Vector3 wrist)
        {
            _given = bones.Count == 2 * Digits * Bones && widths.Count == Digits * Bones;
            int joint = Thumb;
            for (int digit = 0; digit < Digits && _given; digit++)
            {
                int first = (digit * Bones) + (digit == 0 ? 1 : 0), last = (digit + 1) * Bones;
                for (int bone = first; bone <= last; bone++, joint++)
                {
                    _positions[joint] = bone < last ? bones[2 * bone] : bones[(2 * bone) - 1];
                    float before = widths[bone > first ? bone - 1 : first], after = widths[bone < last ? bone : last - 1];
                    _radii[joint] = 0.25f * (before + after);
                }
            }
            _positions[Wrist] = wrist;
            _radii[Wrist] = WristRadius;
            _positions[Palm] = 0.5f * (_positions[MiddleMetacarpal] + _positions[MiddleMetacarpal + 1]);
            _radii[Palm] = _radii[MiddleMetacarpal];
        }
    }
}
