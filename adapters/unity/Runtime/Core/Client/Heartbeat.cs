using System.Threading;

namespace Pacinian
{
    /// <summary>
    /// The time of the game's last tick, which proves that the game is alive, and the worker's gaps since then.
    /// Thread-safe.
    /// </summary>
    internal sealed class Heartbeat
    {
        private double _lastTick = double.NegativeInfinity, _lastStep = double.NaN, _longestGap;

        /// <summary>The time of the last tick [s]; minus infinity before the first one.</summary>
        public double LastTick
        {
            get { return Interlocked.CompareExchange(ref _lastTick, 0.0, 0.0); }
            set { Interlocked.Exchange(ref _lastTick, value); }
        }

        /// <summary>Records a step of the worker. now: [s].</summary>
        public void RecordStep(double now)
        {
            double gap = now - Interlocked.Exchange(ref _lastStep, now);
            if (gap > Interlocked.CompareExchange(ref _longestGap, 0.0, 0.0))
            {
                Interlocked.Exchange(ref _longestGap, gap);
            }
        }

        /// <summary>
        /// Records a tick. still: time since the last tick; worker: longest time within it in which the worker did not
        /// run [s].
        /// </summary>
        public void RecordTick(double now, out double still, out double worker)
        {
            still = now - Interlocked.Exchange(ref _lastTick, now);
            worker = Interlocked.Exchange(ref _longestGap, 0.0);
            double since = now - Interlocked.CompareExchange(ref _lastStep, 0.0, 0.0);
            worker = since > worker ? since : worker;
        }
    }
}
