using UnityEngine;

namespace Pacinian.Haptics
{
    /// <summary>
    /// An open hand that replaces a tracked one. Its palm is at this object and faces down; its fingers point forward.
    /// </summary>
    public sealed partial class HapticHand
    {
        /// <summary>offset: of the palm, in this object's axes without its scale [m].</summary>
        private bool Open(Vector3 offset)
        {
            Quaternion turned = transform.rotation;
            Vector3 palm = transform.position + turned * offset;
            for (int i = 0; i < Count; i++)
            {
                _positions[i] = palm + turned * WireSpace.ToUnity(OpenHand.Joint(side, i));
                _radii[i] = (float)OpenHand.Radius(i);
            }
            return true;
        }
    }
}
