using System.Collections.Generic;
using Pacinian.Wire;
using UnityEngine;

namespace Pacinian.Haptics
{
    /// <summary>The shape of a haptic volume.</summary>
    public enum HapticVolumeShape
    {
        /// <summary>Colliders of this object and its children: boxes, spheres, capsules and closed meshes.</summary>
        Colliders,

        /// <summary>A closed mesh.</summary>
        Mesh,
    }

    /// <summary>The part of a volume that is felt.</summary>
    public enum HapticFelt
    {
        /// <summary>The outside, and a shallow depth below.</summary>
        Shell,

        /// <summary>The whole interior, too.</summary>
        Interior,
    }

    /// <summary>A volume with an even pressure.</summary>
    [AddComponentMenu("Pacinian/Haptic Volume")]
    public sealed class HapticVolume : HapticEffect
    {
        [SerializeField]
        private HapticVolumeShape shape = HapticVolumeShape.Colliders;
        [SerializeField, Tooltip("The mesh; empty: that of the MeshFilter on this object.")]
        private Mesh mesh;
        [SerializeField, Range(0.0001f, 1f), Tooltip("Depth inside the volume up to which a hand feels it [m].")]
        private float thickness = 0.02f;
        [SerializeField]
        private HapticFelt felt = HapticFelt.Shell;

        private readonly List<Collider> _colliders = new List<Collider>();
        private readonly ColliderSnapshot _now = new ColliderSnapshot(), _sent = new ColliderSnapshot();
        private Mesh _mesh;
        private Vector3 _scale;

        /// <summary>The shape.</summary>
        public HapticVolumeShape Shape
        {
            get { return shape; }
            set { shape = value; Refresh(); }
        }

        /// <summary>Shape Mesh: a closed mesh; null: that of the MeshFilter on this object.</summary>
        public Mesh Mesh
        {
            get { return mesh; }
            set { mesh = value; Refresh(); }
        }

        /// <summary>The depth inside the volume up to which a hand feels it [m].</summary>
        public float Thickness
        {
            get { return thickness; }
            set { thickness = value; Refresh(); }
        }

        /// <summary>The part that is felt.</summary>
        public HapticFelt Felt
        {
            get { return felt; }
            set { felt = value; Refresh(); }
        }

        /// <inheritdoc/>
        protected internal override Wire.HapticObject Describe(out string problem)
        {
            _scale = transform.lossyScale;
            VolumeFelt where = felt == HapticFelt.Interior ? VolumeFelt.Interior : VolumeFelt.Shell;
            ISolid made;
            if (shape == HapticVolumeShape.Mesh)
            {
                _mesh = MeshShape.Near(this, mesh);
                made = MeshShape.Of(_mesh, _scale, out problem);
            }
            else
            {
                Take(_sent);
                made = VolumeFromColliders.Of(_colliders, transform, out problem);
            }
            return made == null ? null : new Volume { Shape = made, Thickness = thickness, Felt = where };
        }

        /// <inheritdoc/>
        protected override void Place(Wire.HapticObject felt, Rigid pose)
        {
            HapticPose made = ((Volume)felt).Pose;
            made.Position = pose.Position;
            made.Rotation = pose.Rotation;
        }

        /// <inheritdoc/>
        protected override bool Reshaped()
        {
            if (transform.lossyScale != _scale)
            {
                return true;
            }
            if (shape == HapticVolumeShape.Mesh)
            {
                return MeshShape.Near(this, mesh) != _mesh;
            }
            Take(_now);
            return !_now.Matches(_sent);
        }

        private void Take(ColliderSnapshot snapshot)
        {
            VolumeFromColliders.Collect(this, _colliders);
            snapshot.Take(_colliders, transform);
        }
    }
}
