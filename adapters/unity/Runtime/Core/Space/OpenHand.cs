using Pacinian.Wire;

namespace Pacinian
{
    /// <summary>An adult's open hand, for tests without a tracker. Its palm faces down, its fingers point along y.</summary>
    public static class OpenHand
    {
        /// <summary>The number of OpenXR's joints.</summary>
        public const int Count = 26;

        private static readonly double[] Right = // x, y, z of each joint of a right hand, relative to its palm [mm]
        {
            0, 0, 0, 0, -60, 0, -22, -44, -6, -52, -14, -14, -74, 8, -17, -88, 25, -18,
            -14, -32, 0, -22.5, 31, 0, -27.4966, 71.6944, 0, -30.4215, 95.5155, 0, -32.6152, 113.3813, 0,
            0, -32, 0, 0, 32, 0, 0, 77, 0, 0, 105, 0, 0, 124, 0,
            12, -31, 0, 20.5, 27, 0, 25.6185, 68.6869, 0, 28.909, 95.4857, 0, 31.2245, 114.3441, 0,
            22, -28, 0, 38.5, 17, 0, 47.596, 48.7216, 0, 52.8331, 66.9856, 0, 57.519, 83.3271, 0,
        };

        private static readonly double[] Radii = // [mm]
        {
            20, 21, 19, 12.5, 10, 8.5, 20, 10.5, 8.5, 7.5, 6.5, 20, 11, 8.5, 7.5, 6.5, 19, 10, 8, 7.5, 6.5, 18, 8.5, 7, 6.5, 5.5,
        };

        /// <summary>
        /// Returns a joint relative to the palm [m], in OpenXR's order: palm, wrist, thumb from its metacarpal on,
        /// index...
        /// </summary>
        public static Vec3 Joint(HandFrameSide side, int index)
        {
            double mirror = side == HandFrameSide.Left ? -1e-3 : 1e-3;
            return new Vec3(mirror * Right[3 * index], 1e-3 * Right[3 * index + 1], 1e-3 * Right[3 * index + 2]);
        }

        /// <summary>Returns the distance from a joint to the skin [m].</summary>
        public static double Radius(int index)
        {
            return 1e-3 * Radii[index];
        }

        /// <summary>Writes an open hand into a frame. palm: its pose in the array's frame [m]. Allocates nothing.</summary>
        public static void Write(HandFrame frame, HandFrameSide side, Rigid palm)
        {
            frame.Side = side;
            frame.Joints.Clear();
            frame.Radii.Clear();
            for (int i = 0; i < Count; i++)
            {
                frame.Joints.Add(palm.Point(Joint(side, i)));
                frame.Radii.Add(Radius(i));
            }
        }
    }
}
