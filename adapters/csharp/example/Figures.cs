using System;
using System.Globalization;

namespace Pacinian.Example
{
    /// <summary>Collects numbers for quantiles. Adding a number allocates nothing.</summary>
    public sealed class Figures
    {
        private readonly double[] _all = new double[100000];

        /// <summary>The number of numbers.</summary>
        public int Count { get; private set; }

        /// <summary>Adds a number. Beyond the capacity, new numbers are ignored.</summary>
        public void Add(double value)
        {
            if (Count < _all.Length)
            {
                _all[Count++] = value;
            }
        }

        /// <summary>Returns the quantile for a fraction 0..1; NaN if there are no numbers.</summary>
        public double Quantile(double share)
        {
            Array.Sort(_all, 0, Count);
            return Count == 0 ? double.NaN : _all[(int)Math.Round(share * (Count - 1))];
        }

        /// <summary>Returns a number as JSON.</summary>
        public static string Json(double value)
        {
            bool finite = !double.IsNaN(value) && !double.IsInfinity(value);
            return finite ? value.ToString("R", CultureInfo.InvariantCulture) : "null";
        }
    }
}
