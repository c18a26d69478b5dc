using System.Threading;

namespace Pacinian
{
    /// <summary>Counts emergency stops that are not confirmed. A reset must wait for them. Thread-safe.</summary>
    internal sealed class PendingStops
    {
        private int _count;

        /// <summary>Whether a stop is pending.</summary>
        public bool Any
        {
            get { return Volatile.Read(ref _count) != 0; }
        }

        /// <summary>Counts a stop that has started.</summary>
        public void Begin()
        {
            Interlocked.Increment(ref _count);
        }

        /// <summary>Counts a stop that was confirmed, or given up.</summary>
        public void End()
        {
            Interlocked.Decrement(ref _count);
        }
    }
}
