using UnityEngine;

namespace Pacinian.Haptics
{
    /// <summary>
    /// An open hand that replaces a tracked one. Its palm is at this object and faces down; its fingers point forward.
    /// </summary>
    public sealed partial class HapticHand
    {
        private bool Open()
        {
            Vector3 palm = transform.position;
            Quaternion turned = transform.rotation;
            for (int i = 0; i < Count; i++)
            {
                _positions[i] = palm + turned * WireSpace.ToUnity(OpenHand.Joint(side, i));
                _radii[i] = (float)OpenHand.Radius(i);
            }
            return true;
        }
    }
}
