using System.Threading;

namespace Pacinian
{
    /// <summary>When the game ticked last, which says that it is alive. For any thread.</summary>
    internal sealed class Heartbeat
    {
        private double _lastTick = double.NegativeInfinity;

        /// <summary>[s]; before the first tick, minus infinity.</summary>
        public double LastTick
        {
            get { return Interlocked.CompareExchange(ref _lastTick, 0.0, 0.0); }
            set { Interlocked.Exchange(ref _lastTick, value); }
        }
    }
}
