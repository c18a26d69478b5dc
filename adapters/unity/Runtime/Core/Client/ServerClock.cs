using System;

namespace Pacinian
{
    /// <summary>Round trips of the last renewals [s]: median, 99 % quantile and longest; 0 before the first.</summary>
    public struct RoundTrips
    {
        public double Median, P99, Longest;
    }

    /// <summary>Estimates the offset of the server's clock, and the round trips. Does not read a clock: times are arguments.</summary>
    internal sealed class ServerClock
    {
        private const int Kept = 1000; // round trips
        private const int Marks = 64; // readings of the server's clock

        private readonly SortedWindow _roundTrips = new SortedWindow(Kept);
        private readonly double[] _durations = new double[Marks];
        private readonly double[] _offsets = new double[Marks];
        private int _markCount;

        /// <summary>Records the round trip of a renewal. sent, received: times of the client's clock [s].</summary>
        public void AddRoundTrip(double sent, double received)
        {
            _roundTrips.Add(received - sent);
        }

        /// <summary>Records a reading of the server's clock, taken between these times of the client's clock [s].</summary>
        public void AddMark(double sent, double received, double server)
        {
            _durations[_markCount % Marks] = received - sent;
            _offsets[_markCount++ % Marks] = server - (sent + received) / 2.0;
        }

        /// <summary>
        /// The server's clock minus the client's [s], from the shortest recent round trip: the error is at most half of
        /// it.
        /// </summary>
        public double Offset
        {
            get
            {
                int best = 0;
                for (int i = 1; i < Math.Min(_markCount, Marks); i++)
                {
                    best = _durations[i] < _durations[best] ? i : best;
                }
                return _markCount == 0 ? 0.0 : _offsets[best];
            }
        }

        public RoundTrips RoundTrips
        {
            get
            {
                return new RoundTrips
                {
                    Median = _roundTrips.Quantile(0.5), P99 = _roundTrips.Quantile(0.99), Longest = _roundTrips.Quantile(1.0),
                };
            }
        }
    }
}
