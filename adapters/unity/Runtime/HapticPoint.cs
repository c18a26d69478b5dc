using Pacinian.Wire;
using UnityEngine;

namespace Pacinian.Haptics
{
    /// <summary>A point that presses: a focus where this object is.</summary>
    [AddComponentMenu("Pacinian/Haptic Point")]
    public sealed class HapticPoint : HapticEffect
    {
        [SerializeField, Range(0.0001f, 1f), Tooltip("Of the disc that it presses on [m]; a focus of 40 kHz is about 8.5 mm wide.")]
        private float diameter = 0.0085f;

        /// <summary>Of the disc that it presses on [m].</summary>
        public float Diameter
        {
            get { return diameter; }
            set { diameter = value; Refresh(); }
        }

        /// <inheritdoc/>
        protected internal override Felt Shaped(out string problem)
        {
            problem = "";
            return new Point { Area = 0.25 * System.Math.PI * diameter * diameter };
        }

        /// <inheritdoc/>
        protected override void Place(Felt felt, Rigid pose)
        {
            ((Point)felt).Position = pose.Position;
        }
    }
}
