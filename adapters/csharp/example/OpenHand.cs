using System;
using Pacinian.Wire;

namespace Pacinian.Example
{
    /// <summary>An open right hand, palm down, in place of one that is tracked.</summary>
    public sealed class OpenHand
    {
        private static readonly int[] Joints = // x, y of OpenXR's 26 joints, seen from above [mm]
        {
            0, 0, 0, -60, -22, -44, -52, -14, -74, 8, -88, 25, -14, -32, -22, 31, -27, 72, -30, 96, -33, 113, 0, -32,
            0, 32, 0, 77, 0, 105, 0, 124, 12, -31, 20, 27, 26, 69, 29, 95, 31, 114, 22, -28, 38, 17, 48, 49, 53, 67,
            58, 83,
        };

        private readonly HandFrame _frame = new HandFrame { Side = HandFrameSide.Right };

        /// <summary>With the middle of the palm there, in the world's frame [m]; the same object every time.</summary>
        public HandFrame At(double x, double y, double z)
        {
            _frame.Joints.Clear();
            for (int i = 0; i < Joints.Length; i += 2)
            {
                _frame.Joints.Add(new Vec3(x + 1e-3 * Joints[i], y + 1e-3 * Joints[i + 1], z));
            }
            return _frame;
        }
    }
}
