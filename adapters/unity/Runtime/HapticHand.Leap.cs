using System.Collections.Generic;
using UnityEngine;

namespace Pacinian.Haptics
{
    /// <summary>Hands as Ultraleap's trackers tell them.</summary>
    public sealed partial class HapticHand
    {
        /// <summary>
        /// Of source Game, in place of SetJoints and SetRadii: a hand as Ultraleap tells it, in the world [m]. bones: both ends
        /// (prev and next joint) of the four bones of the five digits from the thumb on: 40. widths: of the 20 bones. wrist: the
        /// arm's next joint. Fewer or more bones or widths: it is lost.
        /// </summary>
        public void SetLeap(IList<Vector3> bones, IList<float> widths, Vector3 wrist)
        {
            _given = LeapHand.Write(bones, widths, wrist, _positions, _radii);
        }
    }
}
