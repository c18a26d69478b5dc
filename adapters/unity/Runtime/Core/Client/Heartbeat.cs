using System.Threading;

namespace Pacinian
{
    /// <summary>When the game ticked last, which says that it is alive, and how the worker ran since. For any thread.</summary>
    internal sealed class Heartbeat
    {
        private double _lastTick = double.NegativeInfinity, _lastStep = double.NaN, _longestGap;

        /// <summary>[s]; before the first tick, minus infinity.</summary>
        public double LastTick
        {
            get { return Interlocked.CompareExchange(ref _lastTick, 0.0, 0.0); }
            set { Interlocked.Exchange(ref _lastTick, value); }
        }

        /// <summary>The worker takes a step. now: [s].</summary>
        public void Step(double now)
        {
            double gap = now - Interlocked.Exchange(ref _lastStep, now);
            if (gap > Interlocked.CompareExchange(ref _longestGap, 0.0, 0.0))
            {
                Interlocked.Exchange(ref _longestGap, gap);
            }
        }

        /// <summary>The game ticks: how long it has not, and the longest of that time in which the worker did not run [s].</summary>
        public void Tick(double now, out double still, out double worker)
        {
            still = now - Interlocked.Exchange(ref _lastTick, now);
            worker = Interlocked.Exchange(ref _longestGap, 0.0);
            double since = now - Interlocked.CompareExchange(ref _lastStep, 0.0, 0.0);
            worker = since > worker ? since : worker;
        }
    }
}
