using System.Collections.Generic;
using UnityEngine;

namespace Leap
{
    public sealed class Frame
    {
        public List<Hand> Hands = new List<Hand>();
    }

    public sealed class Hand
    {
        public bool IsLeft;
        public Bone Arm = new Bone();
#if PACINIAN_ULTRALEAP_7
        public Finger[] fingers = { new Finger(), new Finger(), new Finger(), new Finger(), new Finger() };
#else
        public List<Finger> Fingers = new List<Finger> { new Finger(), new Finger(), new Finger(), new Finger(), new Finger() };
#endif
    }

    public sealed class Finger
    {
        public Bone[] bones = { new Bone(), new Bone(), new Bone(), new Bone() };
    }

    public sealed class Bone
    {
        public Vector3 PrevJoint, NextJoint;
        public float Width;
    }
}

#if PACINIAN_ULTRALEAP_7
namespace Leap
#else
namespace Leap.Unity
#endif
{
    public abstract class LeapProvider : MonoBehaviour
    {
        public abstract Frame CurrentFrame { get; }
    }

    public static class Hands
    {
        public static LeapProvider Provider { get; set; }
    }
}
