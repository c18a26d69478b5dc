using Leap;
#if !PACINIAN_ULTRALEAP_7
using Leap.Unity;
#endif
using UnityEngine;

namespace Pacinian.Haptics
{
    /// <summary>A hand of Ultraleap's tracker, through its Unity plugin (com.ultraleap.tracking).</summary>
    [AddComponentMenu("Pacinian/Leap Hand")]
    public sealed class LeapHandProvider : HandProvider
    {
        [SerializeField, Tooltip("Whether this is the left hand.")] private bool left;
        [SerializeField, Tooltip("The tracker; empty: the scene's.")] private LeapProvider tracker;

        private const int Pause = 60; // frames between two searches for a tracker, because the plugin searches the whole scene

        private readonly Vector3[] _bones = new Vector3[2 * LeapHand.Digits * LeapHand.Bones];
        private readonly float[] _widths = new float[LeapHand.Digits * LeapHand.Bones];
        private int _calls;

        /// <inheritdoc/>
        public override bool TryGet(Vector3[] positions, float[] radii)
        {
            if (tracker == null && _calls++ % Pause == 0)
            {
                tracker = Hands.Provider;
            }
            Frame frame = tracker == null ? null : tracker.CurrentFrame;
            for (int i = 0; frame != null && i < frame.Hands.Count; i++)
            {
                if (frame.Hands[i].IsLeft == left)
                {
                    return Write(frame.Hands[i], positions, radii);
                }
            }
            return false;
        }

        /// <summary>Sets the side. The plugin reports hands in the world, so it needs no origin.</summary>
        public override void Follow(bool left, Transform origin)
        {
            this.left = left;
        }

        private bool Write(Hand hand, Vector3[] positions, float[] radii)
        {
            for (int digit = 0; digit < LeapHand.Digits; digit++)
            {
#if PACINIAN_ULTRALEAP_7
                Finger finger = hand.fingers[digit];
#else
                Finger finger = hand.Fingers[digit];
#endif
                for (int bone = 0; bone < LeapHand.Bones; bone++)
                {
                    int index = (digit * LeapHand.Bones) + bone;
                    _bones[2 * index] = finger.bones[bone].PrevJoint;
                    _bones[(2 * index) + 1] = finger.bones[bone].NextJoint;
                    _widths[index] = finger.bones[bone].Width;
                }
            }
            return LeapHand.Write(_bones, _widths, hand.Arm.NextJoint, positions, radii);
        }
    }
}
