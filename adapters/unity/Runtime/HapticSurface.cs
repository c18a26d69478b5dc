using Pacinian.Wire;
using UnityEngine;

namespace Pacinian.Haptics
{
    /// <summary>A surface that presses evenly: the mesh of this object's MeshFilter, on the side that is seen.</summary>
    [RequireComponent(typeof(MeshFilter))]
    [AddComponentMenu("Pacinian/Haptic Surface")]
    public sealed class HapticSurface : HapticEffect
    {
        [SerializeField, Range(0.001f, 0.2f), Tooltip("How far below it a hand still feels it [m].")]
        private float thickness = 0.02f;

        private UnityEngine.Mesh _mesh;
        private Vector3 _scale;

        /// <summary>How far below it a hand still feels it [m].</summary>
        public float Thickness
        {
            get { return thickness; }
            set { thickness = value; Changed(); }
        }

        /// <inheritdoc/>
        protected override Felt Shaped(out string problem)
        {
            _mesh = GetComponent<MeshFilter>().sharedMesh;
            _scale = transform.lossyScale;
            Wire.Mesh shape = MeshShape.Of(_mesh, _scale, out problem);
            return shape == null ? null : new Surface { Shape = shape, Thickness = thickness };
        }

        /// <inheritdoc/>
        protected override Felt Blank()
        {
            return new Surface();
        }

        /// <inheritdoc/>
        protected override void Place(Felt felt, Rigid pose)
        {
            Wire.Pose made = ((Surface)felt).Pose;
            made.Position = pose.Position;
            made.Rotation = pose.Rotation;
        }

        /// <inheritdoc/>
        protected override bool Reshaped()
        {
            return transform.lossyScale != _scale;
        }
    }
}
