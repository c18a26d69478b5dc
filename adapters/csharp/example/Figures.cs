using System;
using System.Globalization;

namespace Pacinian.Example
{
    /// <summary>Numbers of one kind, of which quantiles are told. It takes no memory while it takes numbers.</summary>
    public sealed class Figures
    {
        private readonly double[] _all = new double[100000];

        /// <summary>How many there are.</summary>
        public int Count { get; private set; }

        /// <summary>One more; of too many, the first stay.</summary>
        public void Add(double value)
        {
            if (Count < _all.Length)
            {
                _all[Count++] = value;
            }
        }

        /// <summary>That share of them, 0..1, is not larger; NaN of none.</summary>
        public double Quantile(double share)
        {
            Array.Sort(_all, 0, Count);
            return Count == 0 ? double.NaN : _all[(int)Math.Round(share * (Count - 1))];
        }

        /// <summary>A number as JSON has it.</summary>
        public static string Json(double value)
        {
            bool finite = !double.IsNaN(value) && !double.IsInfinity(value);
            return finite ? value.ToString("R", CultureInfo.InvariantCulture) : "null";
        }
    }
}
