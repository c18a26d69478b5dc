using System;

namespace Pacinian
{
    /// <summary>Creates the built-in transports.</summary>
    public static class Transports
    {
        /// <summary>Returns a transport for all kinds of connections, not connected.</summary>
        public static ITransport Make()
        {
            return new DefaultTransport();
        }

        /// <summary>
        /// Returns a transport for CURVE keys. Raises DllNotFoundException if it needs libzmq, and libzmq is not
        /// installed.
        /// </summary>
        internal static ITransport MakeCurve()
        {
#if PACINIAN_NETMQ
            return new NetMqTransport();
#else
            return new ZmqTransport();
#endif
        }

        /// <summary>Returns whether an exception says that a native library is missing, or cannot be used.</summary>
        internal static bool IsMissingLibrary(Exception error)
        {
            return error is DllNotFoundException || error is BadImageFormatException || error is EntryPointNotFoundException;
        }
    }
}
