namespace Pacinian
{
    /// <summary>The transports that are built in.</summary>
    public static class Transports
    {
        /// <summary>One that is not connected, for all connections.</summary>
        public static ITransport Make()
        {
            return new DefaultTransport();
        }

        /// <summary>One for CURVE keys. Raises DllNotFoundException where libzmq is needed and not installed.</summary>
        internal static ITransport MakeCurve()
        {
#if PACINIAN_NETMQ
            return new NetMqTransport();
#else
            return new ZmqTransport();
#endif
        }
    }
}
