using System.Globalization;
using Pacinian.Wire;

namespace Pacinian
{
    /// <summary>
    /// What is felt of an object's surface or volume, against what was asked: between its samples, over the last second or
    /// so. All numbers are NaN where the server does not tell: of points and paths, and in silence.
    /// </summary>
    public struct RegionFelt
    {
        private const int Figures = 4; // of each object

        /// <summary>Force over what was asked; 1 if right.</summary>
        public float Force;

        /// <summary>Root mean square of the error of radiation pressure, over that of what was asked; 0 if right.</summary>
        public float Rms;

        /// <summary>Share of the region that is pressed with less than half of what was asked; 0 if right.</summary>
        public float Holes;

        /// <summary>Highest radiation pressure 3 to 5 mm beside the region, over the mean asked.</summary>
        public float Spill;

        /// <summary>Whether the server tells.</summary>
        public bool Known
        {
            get { return !float.IsNaN(Force); }
        }

        /// <summary>Of the object of that name, in a state; nothing is allocated. state: may be null.</summary>
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

        /// <summary>In one line, for people.</summary>
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
