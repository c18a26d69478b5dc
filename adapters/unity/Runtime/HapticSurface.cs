using Pacinian.Wire;
using UnityEngine;

namespace Pacinian.Haptics
{
    /// <summary>The shape of a haptic surface.</summary>
    public enum HapticSurfaceShape
    {
        /// <summary>A mesh, felt on its visible side.</summary>
        Mesh,

        /// <summary>A rectangle in the object's x and z, felt from above.</summary>
        Rectangle,

        /// <summary>A disc in the object's x and z, felt from above.</summary>
        Disc,
    }

    /// <summary>A surface with an even pressure.</summary>
    [AddComponentMenu("Pacinian/Haptic Surface")]
    public sealed class HapticSurface : HapticEffect
    {
        [SerializeField]
        private HapticSurfaceShape shape = HapticSurfaceShape.Mesh;
        [SerializeField, Tooltip("The mesh; empty: that of the MeshFilter on this object.")]
        private Mesh mesh;
        [SerializeField, Tooltip("Size of a rectangle along x and z [m].")]
        private Vector2 size = new Vector2(0.1f, 0.1f);
        [SerializeField, Range(0.0001f, 1f), Tooltip("Radius of a disc [m].")]
        private float radius = 0.05f;
        [SerializeField, Range(0.0001f, 1f), Tooltip("Depth below the surface up to which a hand feels it [m].")]
        private float thickness = 0.02f;

        private static readonly Quat HalfTurn = new Quat(1.0, 0.0, 0.0, 0.0); // about x

        private Mesh _mesh;
        private Vector3 _scale;

        /// <summary>The shape.</summary>
        public HapticSurfaceShape Shape
        {
            get { return shape; }
            set { shape = value; Refresh(); }
        }

        /// <summary>Shape Mesh: the mesh; null: that of the MeshFilter on this object.</summary>
        public Mesh Mesh
        {
            get { return mesh; }
            set { mesh = value; Refresh(); }
        }

        /// <summary>The size of a rectangle along x and z [m].</summary>
        public Vector2 Size
        {
            get { return size; }
            set { size = value; Refresh(); }
        }

        /// <summary>The radius of a disc [m].</summary>
        public float Radius
        {
            get { return radius; }
            set { radius = value; Refresh(); }
        }

        /// <summary>The depth below the surface up to which a hand feels it [m].</summary>
        public float Thickness
        {
            get { return thickness; }
            set { thickness = value; Refresh(); }
        }

        /// <summary>Turned over if a negative scale along y mirrors a rectangle or disc. A mesh has mirrored faces instead.</summary>
        internal override Rigid ShapePose
        {
            get
            {
                bool below = shape != HapticSurfaceShape.Mesh && transform.lossyScale.y < 0f;
                return below ? base.ShapePose * new Rigid(new Vec3(), HalfTurn) : base.ShapePose;
            }
        }

        /// <inheritdoc/>
        protected internal override HapticObject Describe(out string problem)
        {
            problem = "";
            _scale = transform.lossyScale;
            IShell made;
            switch (shape)
            {
                case HapticSurfaceShape.Rectangle:
                    made = new Rectangle { Width = size.x * Mathf.Abs(_scale.x), Height = size.y * Mathf.Abs(_scale.z) };
                    break;
                case HapticSurfaceShape.Disc:
                    made = new Disc { Radius = radius * Mathf.Max(Mathf.Abs(_scale.x), Mathf.Abs(_scale.z)) };
                    break;
                default:
                    _mesh = MeshShape.Near(this, mesh);
                    made = MeshShape.Of(_mesh, _scale, out problem);
                    break;
            }
            return made == null ? null : new Surface { Shape = made, Thickness = thickness };
        }

        /// <inheritdoc/>
        protected override void Place(HapticObject felt, Rigid pose)
        {
            HapticPose made = ((Surface)felt).Pose;
            made.Position = pose.Position;
            made.Rotation = pose.Rotation;
        }

        /// <inheritdoc/>
        protected override bool Reshaped()
        {
            return transform.lossyScale != _scale || (shape == HapticSurfaceShape.Mesh && MeshShape.Near(this, mesh) != _mesh);
        }
    }
}
