using System.Diagnostics;

namespace Pacinian
{
    /// <summary>This computer's monotonic clock.</summary>
    internal static class SteadyClock
    {
        /// <summary>Returns the time [s].</summary>
        public static double Now()
        {
            return Stopwatch.GetTimestamp() / (double)Stopwatch.Frequency;
        }
    }
}
