using System.Globalization;
using Pacinian.Wire;

namespace Pacinian
{
    /// <summary>
    /// The achieved pressure of an object's surface or volume, compared with the requested one, over about the last
    /// second: on all touched skin or, in free air, between the samples. All numbers are NaN if the server does not
    /// report them: for points and paths, and in silence.
    /// </summary>
    public struct RegionFelt
    {
        private const int Figures = 4; // for each object

        /// <summary>Achieved force divided by the requested one; 1 is ideal.</summary>
        public float Force;

        /// <summary>Root mean square error of the radiation pressure, relative to that of the requested one; 0 is ideal.</summary>
        public float Rms;

        /// <summary>The fraction of the region with less than half of the requested pressure; 0 is ideal.</summary>
        public float Holes;

        /// <summary>
        /// The highest radiation pressure beside the region (3 to 30 mm on skin, 3 to 5 mm in free air), relative to the
        /// mean requested one.
        /// </summary>
        public float Spill;

        /// <summary>Whether the server reports the numbers.</summary>
        public bool Known
        {
            get { return !float.IsNaN(Force); }
        }

        /// <summary>Returns the numbers of the object with this name. Allocates nothing. state: may be null.</summary>
        public static RegionFelt Of(State state, string name)
        {
            bool told = state != null && state.Output == Output.Sounding && state.Felt.Numbers == Figures * state.Objects.Count;
            for (int i = 0; told && i < state.Objects.Count; i++)
            {
                if (state.Objects[i] == name)
                {
                    return new RegionFelt
                    {
                        Force = state.Felt.Single(Figures * i),
                        Rms = state.Felt.Single((Figures * i) + 1),
                        Holes = state.Felt.Single((Figures * i) + 2),
                        Spill = state.Felt.Single((Figures * i) + 3),
                    };
                }
            }
            return new RegionFelt { Force = float.NaN, Rms = float.NaN, Holes = float.NaN, Spill = float.NaN };
        }

        /// <summary>Returns the numbers in one line.</summary>
        public override string ToString()
        {
            return Known
                ? string.Format(
                    CultureInfo.InvariantCulture, "force {0:F0} %, rms error {1:F0} %, holes {2:F0} %, beside it {3:F0} %",
                    100f * Force, 100f * Rms, 100f * Holes, 100f * Spill)
                : "not known";
        }
    }
}
