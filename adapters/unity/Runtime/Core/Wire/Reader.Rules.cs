using System.Globalization;

namespace Pacinian.Wire
{
    /// <summary>Checks ranges and the rules for bulk numbers.</summary>
    public sealed partial class Reader
    {
        /// <summary>
        /// Checks that data consists of rows of `width` 32-bit numbers. count, other: the allowed numbers of rows; -1:
        /// any.
        /// </summary>
        internal bool Rows(string name, ref Bulk data, long width, long count = -1, long other = -1)
        {
            long rows = data.Count / (4 * width);
            bool whole = rows * 4 * width == data.Count;
            return (whole && (count < 0 || rows == count || rows == other))
                || In(name, "must be " + (count < 0 ? "" : count + " ") + "rows of " + width + " numbers of 32 bits");
        }

        /// <summary>Checks that all float32 are in low..high and none is NaN.</summary>
        internal bool Range(string name, ref Bulk data, double low, double high)
        {
            for (int i = 0; i < data.Numbers; i++)
            {
                float value = data.Single(i);
                if (!(value >= low && value <= high))
                {
                    return In(name, Between(low, high) + ", without NaN");
                }
            }
            return true;
        }

        /// <summary>Checks that data consists of rows of three uint32, all less than `below`.</summary>
        internal bool Indices(string name, ref Bulk data, int below)
        {
            if (!Rows(name, ref data, 3))
            {
                return false;
            }
            for (int i = 0; i < data.Numbers; i++)
            {
                if (data.Index(i) >= below)
                {
                    return In(name, "must be indices of the " + below + " that there are");
                }
            }
            return true;
        }

        private bool In(string name, string problem)
        {
            Fail(problem);
            return Within("." + name);
        }

        private static string Between(double low, double high, bool above = false)
        {
            return "must be " + (above ? "more than " : "from ") + Said(low) + (above ? " and at most " : " to ") + Said(high);
        }

        private static string Said(double value)
        {
            return value.ToString("R", CultureInfo.InvariantCulture);
        }
    }
}
