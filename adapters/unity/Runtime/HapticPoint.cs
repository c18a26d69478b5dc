using Pacinian.Wire;
using UnityEngine;

namespace Pacinian.Haptics
{
    /// <summary>A point that presses: a focus where this object is.</summary>
    [AddComponentMenu("Pacinian/Haptic Point")]
    public sealed class HapticPoint : HapticEffect
    {
        [SerializeField, Range(0.001f, 0.05f), Tooltip("Of the disc that it presses on [m].")]
        private float radius = 0.00425f;

        /// <summary>Of the disc that it presses on [m].</summary>
        public float Radius
        {
            get { return radius; }
            set { radius = value; Changed(); }
        }

        /// <inheritdoc/>
        protected override Felt Shaped(out string problem)
        {
            problem = "";
            return new Point { Area = System.Math.PI * radius * radius };
        }

        /// <inheritdoc/>
        protected override Felt Blank()
        {
            return new Point();
        }

        /// <inheritdoc/>
        protected override void Place(Felt felt, Rigid pose)
        {
            ((Point)felt).Position = pose.Position;
        }
    }
}
