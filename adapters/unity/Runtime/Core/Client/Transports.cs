namespace Pacinian
{
    /// <summary>The transport that is built in: NetMQ where PACINIAN_NETMQ is defined, else libzmq.</summary>
    public static class Transports
    {
        /// <summary>One that is not connected.</summary>
        public static ITransport Make()
        {
#if PACINIAN_NETMQ
            return new NetMqTransport();
#else
            return new ZmqTransport();
#endif
        }
    }
}
