using System;
using System.Diagnostics;

namespace Pacinian
{
    /// <summary>Round trips of late [s]: median, 99 % and the longest; 0 before the first.</summary>
    public struct Trips
    {
        public double Median, P99, Longest;
    }

    /// <summary>The last round trips, and how the server's clock lies to ours. Pure: times are given.</summary>
    internal sealed class Timing
    {
        private const int Kept = 1000; // round trips
        private const int Marks = 64; // looks at the server's clock

        private readonly Sorted _trips = new Sorted(Kept);
        private readonly double[] _durations = new double[Marks];
        private readonly double[] _offsets = new double[Marks];
        private int _markCount;

        /// <summary>This computer's steady clock [s].</summary>
        public static double Now()
        {
            return Stopwatch.GetTimestamp() / (double)Stopwatch.Frequency;
        }

        /// <summary>A renewal was sent, and answered, at these times of our clock [s]; the server's was between.</summary>
        public void Answered(double sent, double received, double server)
        {
            _trips.Add(received - sent);
            Clocked(sent, received, server);
        }

        /// <summary>Between these times of our clock the server's was that [s].</summary>
        public void Clocked(double sent, double received, double server)
        {
            _durations[_markCount % Marks] = received - sent;
            _offsets[_markCount++ % Marks] = server - (sent + received) / 2.0;
        }

        /// <summary>Server's clock less ours [s], from the shortest trip of late: off by at most half of it.</summary>
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

        public Trips Trips
        {
            get
            {
                return new Trips
                {
                    Median = _trips.Quantile(0.5), P99 = _trips.Quantile(0.99), Longest = _trips.Quantile(1.0),
                };
            }
        }
    }
}
