using UnityEngine;

namespace Pacinian.Haptics
{
    /// <summary>Draws a selected effect as it will be felt, in its true size, also in edit mode.</summary>
    public abstract partial class HapticEffect
    {
        private Wire.HapticObject _shape;
        private bool _drawn;

        /// <summary>Draws the shape that the server gets, in red if it cannot be felt.</summary>
        protected virtual void OnDrawGizmosSelected()
        {
            if (!_drawn || Reshaped())
            {
                string problem;
                _shape = Describe(out problem);
                _drawn = _changed = true; // so that the server gets it, too
                Problem = isActiveAndEnabled && Playing ? Problem : problem;
            }
            Gizmos.color = Problem.Length > 0 ? Color.red : new Color(0.3f, 0.8f, 1f);
            if (_shape != null)
            {
                ShapeGizmo.Draw(_shape, ShapePose);
            }
            Gizmos.matrix = Matrix4x4.identity;
        }
    }
}
