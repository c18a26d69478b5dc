using UnityEngine;

namespace Pacinian.Haptics
{
    /// <summary>The source of a tracked hand. Derive from this class to support another tracker.</summary>
    public abstract class HandProvider : MonoBehaviour
    {
        /// <summary>
        /// Writes the joints of the hand, in OpenXR's order: palm, wrist, then thumb (4), index, middle, ring and
        /// little finger (5 each), from the palm to the tip.
        /// </summary>
        /// <param name="positions">Receives 26 positions in the world [m].</param>
        /// <param name="radii">Receives 26 radii [m]; all 0 if the tracker does not know them.</param>
        /// <returns>False if the hand is not tracked.</returns>
        public abstract bool TryGet(Vector3[] positions, float[] radii);

        /// <summary>
        /// Sets the hand's side and the frame in which the tracker reports it; null is the world. GameObject > Pacinian
        /// > Hands calls this.
        /// </summary>
        public virtual void Follow(bool left, Transform origin)
        {
        }
    }
}
