using System;

namespace Pacinian
{
    /// <summary>
    /// Chooses the transport: .NET's sockets if the connection has a token, as on the same machine; libzmq (or NetMQ if
    /// PACINIAN_NETMQ is defined) if it has CURVE keys.
    /// </summary>
    public sealed class DefaultTransport : ITransport
    {
        private readonly ManagedTransport _managed = new ManagedTransport();
        private volatile ITransport _current, _curve;

        /// <summary>Creates a transport that is not connected.</summary>
        public DefaultTransport()
        {
            _current = _managed;
        }

        /// <inheritdoc/>
        public string Open(ConnectionFile file, bool all)
        {
            Close();
            _current = _managed;
            if (file.ServerKey.Length > 0)
            {
                try
                {
                    _curve = _curve ?? Transports.MakeCurve();
                }
                catch (Exception error) when (Transports.IsMissingLibrary(error))
                {
                    return ErrorMessages.DescribeException(error);
                }
                _current = _curve;
            }
            return _current.Open(file, all);
        }

        /// <inheritdoc/>
        public Ending Ended()
        {
            return _current.Ended();
        }

        /// <inheritdoc/>
        public string Problem
        {
            get { return _current.Problem; }
        }

        /// <inheritdoc/>
        public bool Room(Channel channel)
        {
            return _current.Room(channel);
        }

        /// <inheritdoc/>
        public bool Send(Channel channel, byte[] data, int count)
        {
            return _current.Send(channel, data, count);
        }

        /// <inheritdoc/>
        public int Receive(Channel channel, byte[] into)
        {
            return _current.Receive(channel, into);
        }

        /// <inheritdoc/>
        public void Wait(double seconds)
        {
            _current.Wait(seconds);
        }

        /// <inheritdoc/>
        public void Wake()
        {
            _managed.Wake();
            _curve?.Wake();
        }

        /// <inheritdoc/>
        public void Close()
        {
            _current.Close();
        }

        /// <inheritdoc/>
        public void Dispose()
        {
            _managed.Dispose();
            _curve?.Dispose();
        }
    }
}
