using System.Collections.Generic;

namespace UnityEngine
{
    /// <summary>Position, rotation and scale relative to a parent, without shear.</summary>
    public sealed class Transform : Component
    {
        internal readonly List<Transform> Children = new List<Transform>();
        private Transform _parent;

        public Vector3 localPosition { get; set; }

        public Quaternion localRotation { get; set; } = Quaternion.identity;

        public Vector3 localScale { get; set; } = Vector3.one;

        public Transform parent
        {
            get { return _parent; }
        }

        public Transform root
        {
            get { return _parent == null ? this : _parent.root; }
        }

        public Vector3 position
        {
            get { return _parent == null ? localPosition : _parent.TransformPoint(localPosition); }
            set { localPosition = _parent == null ? value : _parent.InverseTransformPoint(value); }
        }

        public Quaternion rotation
        {
            get { return _parent == null ? localRotation : _parent.rotation * localRotation; }
            set { localRotation = _parent == null ? value : Quaternion.Inverse(_parent.rotation) * value; }
        }

        public Vector3 lossyScale
        {
            get { return _parent == null ? localScale : Vector3.Scale(_parent.lossyScale, localScale); }
        }

        public void SetParent(Transform above, bool stays)
        {
            Vector3 place = position;
            Quaternion turned = rotation;
            _parent?.Children.Remove(this);
            _parent = above;
            above.Children.Add(this);
            if (stays)
            {
                position = place;
                rotation = turned;
            }
        }

        public Vector3 TransformPoint(Vector3 point)
        {
            return position + rotation * Vector3.Scale(lossyScale, point);
        }

        public Vector3 InverseTransformPoint(Vector3 point)
        {
            Vector3 near = Quaternion.Inverse(rotation) * (point - position), scale = lossyScale;
            return new Vector3(near.x / scale.x, near.y / scale.y, near.z / scale.z);
        }
    }
}
