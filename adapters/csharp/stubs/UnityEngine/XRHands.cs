namespace UnityEngine.XR.Hands
{
    public enum XRHandJointID
    {
        Invalid,
        Wrist,
        Palm,
        ThumbMetacarpal,
    }

    public struct XRHandJoint
    {
        public bool TryGetPose(out Pose pose)
        {
            pose = new Pose();
            return false;
        }

        public bool TryGetRadius(out float radius)
        {
            radius = 0f;
            return false;
        }
    }

    public struct XRHand
    {
        public bool isTracked
        {
            get { return false; }
        }

        public XRHandJoint GetJoint(XRHandJointID id)
        {
            return new XRHandJoint();
        }
    }

    public sealed class XRHandSubsystem
    {
        public bool running
        {
            get { return false; }
        }

        public XRHand leftHand
        {
            get { return new XRHand(); }
        }

        public XRHand rightHand
        {
            get { return new XRHand(); }
        }
    }
}
