using System.Threading;

namespace Pacinian
{
    /// <summary>Emergency stops that are not confirmed yet: nothing may be reset before they are. For any thread.</summary>
    internal sealed class PendingStops
    {
        private int _count;

        /// <summary>Whether there is one.</summary>
        public bool Any
        {
            get { return Volatile.Read(ref _count) != 0; }
        }

        /// <summary>One has begun.</summary>
        public void Begin()
        {
            Interlocked.Increment(ref _count);
        }

        /// <summary>One was confirmed, or given up.</summary>
        public void End()
        {
            Interlocked.Decrement(ref _count);
        }
    }
}
