using System.Collections.Generic;
using Pacinian.Wire;
using UnityEngine;

namespace Pacinian.Haptics
{
    /// <summary>A volume that presses evenly: this object's colliders, of which each is a box, sphere, capsule or closed mesh.</summary>
    [AddComponentMenu("Pacinian/Haptic Volume")]
    public sealed class HapticVolume : HapticEffect
    {
        [SerializeField, Range(0.001f, 0.2f), Tooltip("How far inside a hand still feels it [m].")]
        private float thickness = 0.02f;
        [SerializeField, Tooltip("All of it is felt, not only its shell.")]
        private bool interior;

        private readonly List<Collider> _colliders = new List<Collider>();
        private Vector3 _scale;

        /// <summary>How far inside a hand still feels it [m].</summary>
        public float Thickness
        {
            get { return thickness; }
            set { thickness = value; Changed(); }
        }

        /// <summary>Whether all of it is felt, not only its shell.</summary>
        public bool Interior
        {
            get { return interior; }
            set { interior = value; Changed(); }
        }

        /// <inheritdoc/>
        protected override Felt Shaped(out string problem)
        {
            _scale = transform.lossyScale;
            GetComponents(_colliders);
            ISolid shape = ColliderShape.Of(_colliders, _scale, out problem);
            VolumeFelt felt = interior ? VolumeFelt.Interior : VolumeFelt.Shell;
            return shape == null ? null : new Volume { Shape = shape, Thickness = thickness, Felt = felt };
        }

        /// <inheritdoc/>
        protected override Felt Blank()
        {
            return new Volume();
        }

        /// <inheritdoc/>
        protected override void Place(Felt felt, Rigid pose)
        {
            Wire.Pose made = ((Volume)felt).Pose;
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
