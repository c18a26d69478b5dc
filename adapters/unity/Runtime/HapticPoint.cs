using Pacinian.Wire;
using UnityEngine;

namespace Pacinian.Haptics
{
    /// <summary>A focus at this object's position.</summary>
    [AddComponentMenu("Pacinian/Haptic Point")]
    public sealed class HapticPoint : HapticEffect
    {
        [SerializeField, Range(0.0001f, 1f), Tooltip("Diameter of the disc under pressure [m]; a focus at 40 kHz: about 8.5 mm.")]
        private float diameter = 0.0085f;

        /// <summary>The diameter of the disc under pressure [m].</summary>
        public float Diameter
        {
            get { return diameter; }
            set { diameter = value; Refresh(); }
        }

        /// <inheritdoc/>
        protected internal override HapticObject Describe(out string problem)
        {
            problem = "";
            return new Point { Area = 0.25 * System.Math.PI * diameter * diameter };
        }

        /// <inheritdoc/>
        protected override void Place(HapticObject felt, Rigid pose)
        {
            ((Point)felt).Position = pose.Position;
        }
    }
}
