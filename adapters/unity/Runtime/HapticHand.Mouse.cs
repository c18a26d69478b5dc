using UnityEngine;

namespace Pacinian.Haptics
{
    /// <summary>An open hand that the mouse moves, to both sides, forward and back.</summary>
    public sealed partial class HapticHand
    {
        /// <summary>Source Mouse: how far the hand is from this object when the mouse is at the window's edge [m].</summary>
        public float MouseReach
        {
            get { return mouseReach; }
            set { mouseReach = value; }
        }

        private bool FollowMouse()
        {
            Vector2 place;
            return MouseInput.Held(out place) && Open(mouseReach * new Vector3(place.x, 0f, place.y));
        }
    }
}
