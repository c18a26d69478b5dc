using System;

namespace Pacinian
{
    /// <summary>The last so many numbers, in their order of size. It takes no memory while it takes numbers.</summary>
    internal sealed class Sorted
    {
        private readonly double[] _ring, _sorted;
        private int _next;

        /// <summary>kept: how many; of more, the oldest are forgotten.</summary>
        public Sorted(int kept)
        {
            _ring = new double[kept];
            _sorted = new double[kept];
        }

        /// <summary>How many there are.</summary>
        public int Count { get; private set; }

        /// <summary>One more.</summary>
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

        /// <summary>That share of them, 0..1, is not larger; 0 before the first.</summary>
        public double Quantile(double share)
        {
            return Count == 0 ? 0.0 : _sorted[(int)Math.Round(share * (Count - 1))];
        }

        /// <summary>How many are smaller.</summary>
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
