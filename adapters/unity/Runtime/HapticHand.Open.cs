using UnityEngine;

namespace Pacinian.Haptics
{
    /// <summary>An open hand in place of a tracked one: its palm is here and faces down, its fingers point forward.</summary>
    public sealed partial class HapticHand
    {
        private bool Open()
        {
            Vector3 palm = transform.position;
            Quaternion turned = transform.rotation;
            for (int i = 0; i < Count; i++)
            {
                _positions[i] = palm + turned * Frames.Back(OpenHand.Joint(side, i));
                _radii[i] = (float)OpenHand.Radius(i);
            }
            return true;
        }
    }
}
