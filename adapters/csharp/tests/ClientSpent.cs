using System;
using System.Runtime.InteropServices;

namespace Pacinian.Tests
{
    /// <summary>
    /// What calls take of a game's frame: of each the whole time if it waited for anything, else that of the processor.
    /// What others take of the machine meanwhile is no fault of the call; but of waiting by yielding only the processor's
    /// time counts, and one short wait for a lock counts all. For one thread, on Linux.
    /// </summary>
    internal sealed class ClientSpent
    {
        private const int Monotonic = 1, OfThread = 3, Thread = 1, Waits = 16;

        private readonly long[] _time = new long[2], _used = new long[18];
        private double _begin, _processor;
        private long _waits;

        /// <summary>Of a call, the longest since it was set to 0 [s].</summary>
        public double Longest { get; set; }

        /// <summary>A call begins.</summary>
        public void Begin()
        {
            _waits = Waited();
            _processor = Of(OfThread);
            _begin = Of(Monotonic);
        }

        /// <summary>It has ended.</summary>
        public void End()
        {
            double whole = Of(Monotonic) - _begin, processor = Of(OfThread) - _processor;
            Longest = Math.Max(Longest, Waited() > _waits ? whole : processor);
        }

        private double Of(int clock)
        {
            clock_gettime(clock, _time);
            return _time[0] + 1e-9 * _time[1];
        }

        /// <summary>How often the thread has given up the processor by itself.</summary>
        private long Waited()
        {
            getrusage(Thread, _used);
            return _used[Waits];
        }

        [DllImport("libc")]
        private static extern int clock_gettime(int clock, [In, Out] long[] time);

        [DllImport("libc")]
        private static extern int getrusage(int who, [In, Out] long[] used);
    }
}
