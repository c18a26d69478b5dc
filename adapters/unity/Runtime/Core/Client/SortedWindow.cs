using System;

namespace Pacinian
{
    /// <summary>The last numbers of a series, sorted. Adding a number allocates nothing.</summary>
    internal sealed class SortedWindow
    {
        private readonly double[] _ring, _sorted;
        private int _next;

        /// <summary>kept: the capacity; beyond it, the oldest numbers are dropped.</summary>
        public SortedWindow(int kept)
        {
            _ring = new double[kept];
            _sorted = new double[kept];
        }

        /// <summary>The number of numbers.</summary>
        public int Count { get; private set; }

        /// <summary>Adds a number.</summary>
        public void Add(double value)
        {
            if (Count == _ring.Length)
            {
                int old = Place(_ring[_next]);
                Array.Copy(_sorted, old + 1, _sorted, old, --Count - old);
            }
            int at = Place(value);
            Array.Copy(_sorted, at, _sorted, at + 1, Count++ - at);
            _sorted[at] = _ring[_next] = value;
            _next = (_next + 1) % _ring.Length;
        }

        /// <summary>Returns the quantile for a fraction 0..1; 0 before the first number.</summary>
        public double Quantile(double share)
        {
            return Count == 0 ? 0.0 : _sorted[(int)Math.Round(share * (Count - 1))];
        }

        /// <summary>Returns how many numbers are smaller.</summary>
        private int Place(double value)
        {
            int low = 0, high = Count;
            while (low < high)
            {
                int middle = (low + high) / 2;
                if (_sorted[middle] < value)
                {
                    low = middle + 1;
                }
                else
                {
                    high = middle;
                }
            }
            return low;
        }
    }
}
