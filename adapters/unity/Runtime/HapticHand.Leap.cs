using System.Collections.Generic;
using UnityEngine;

namespace Pacinian.Haptics
{
    /// <summary>Hands in the form of Ultraleap's trackers.</summary>
    public sealed partial class HapticHand
    {
        /// <summary>
        /// Source Game: sets the hand from Ultraleap's data, in the world [m], instead of SetJoints and SetRadii.
        /// bones: both ends (prev and next joint) of the four bones of each digit, from the thumb on: 40 positions.
        /// widths: of the 20 bones. wrist: the arm's next joint. If a count differs, the hand is lost.
        /// </summary>
        public void SetLeap(IList<Vector3> bones, IList<float> widths, Vector3 wrist)
        {
            _given = LeapHand.Write(bones, widths, wrist, _positions, _radii);
        }
    }
}
