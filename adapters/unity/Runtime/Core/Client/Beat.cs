using System.Threading;

namespace Pacinian
{
    /// <summary>When the game ticked last: what says that it is alive. And whether a stop is under way.</summary>
    internal sealed class Beat
    {
        private double _ticked = double.NegativeInfinity;
        private int _stops;

        /// <summary>[s]; before the first tick, minus infinity.</summary>
        public double Ticked
        {
            get { return Interlocked.CompareExchange(ref _ticked, 0.0, 0.0); }
            set { Interlocked.Exchange(ref _ticked, value); }
        }

        /// <summary>Whether a stop has begun that is not confirmed yet: nothing may be reset before it is.</summary>
        public bool Stopping
        {
            get { return Volatile.Read(ref _stops) != 0; }
        }

        public void BeginStop()
        {
            Interlocked.Increment(ref _stops);
        }

        public void EndStop()
        {
            Interlocked.Decrement(ref _stops);
        }
    }
}
