using System;

namespace Pacinian
{
    /// <summary>Decides when to connect again. Does not read a clock: times are arguments [s].</summary>
    internal sealed class ReconnectBackoff
    {
        public const double Shortest = 0.1, Longest = 2.0; // [s] pauses
        public const double Unasked = 0.5; // [s] longest pause if no server was asked, because reading a file costs little

        private string _problem = "";
        private double _pause = Shortest;

        /// <summary>When the next attempt is due.</summary>
        public double Due { get; private set; } = double.NegativeInfinity;

        /// <summary>Records that a session has started.</summary>
        public void RecordSuccess()
        {
            _problem = "";
            _pause = Shortest;
        }

        /// <summary>
        /// Records that an attempt failed, or that a session was lost. Another problem than the last one restarts the
        /// pauses. longest: the longest pause after this one [s].
        /// </summary>
        public void RecordFailure(string problem, double now, double longest = Longest)
        {
            _pause = problem != _problem ? Shortest : _pause;
            _problem = problem;
            Due = now + _pause;
            _pause = Math.Min(2.0 * _pause, longest);
        }
    }
}
