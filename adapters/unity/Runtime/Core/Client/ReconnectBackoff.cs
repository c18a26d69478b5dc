using System;

namespace Pacinian
{
    /// <summary>Decides when to connect again. Does not read a clock: times are arguments [s].</summary>
    internal sealed class ReconnectBackoff
    {
        public const double MinPause = 0.1, MaxPause = 2.0; // [s]
        public const double MaxPauseWithoutServer = 0.5; // [s] shorter, because such an attempt costs little

        private string _problem = "";
        private double _pause = MinPause;

        /// <summary>When the next attempt is due.</summary>
        public double Due { get; private set; } = double.NegativeInfinity;

        /// <summary>Records that a session has started.</summary>
        public void RecordSuccess()
        {
            _problem = "";
            _pause = MinPause;
        }

        /// <summary>
        /// Records that an attempt failed, or that a session was lost. If the problem differs from the previous problem,
        /// the pauses begin again at MinPause. maxPause: upper limit of the later pauses [s].
        /// </summary>
        public void RecordFailure(string problem, double now, double maxPause = MaxPause)
        {
            _pause = problem != _problem ? MinPause : _pause;
            _problem = problem;
            Due = now + _pause;
            _pause = Math.Min(2.0 * _pause, maxPause);
        }
    }
}
