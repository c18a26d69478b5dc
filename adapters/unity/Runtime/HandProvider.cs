using UnityEngine;

namespace Pacinian.Haptics
{
    /// <summary>Where a tracked hand comes from: derive from this for another tracker.</summary>
    public abstract class HandProvider : MonoBehaviour
    {
        /// <summary>
        /// Joints of the hand now, in OpenXR's order: palm, wrist, then thumb (4), index, middle, ring and little finger
        /// (5 each), from the palm to the tip.
        /// </summary>
        /// <param name="positions">26 places in the world [m], to be written.</param>
        /// <param name="radii">26 radii [m], to be written; all 0 where they are not known.</param>
        /// <returns>False: the hand is not tracked.</returns>
        public abstract bool TryGet(Vector3[] positions, float[] radii);

        /// <summary>
        /// Whether it is the left hand, and in whose frame the tracker tells it; null: the world's. For those that are made by
        /// GameObject > Pacinian > Hands.
        /// </summary>
        public virtual void Follow(bool left, Transform origin)
        {
        }
    }
}
