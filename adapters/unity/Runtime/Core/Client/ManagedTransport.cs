using System;
using System.Net;
using System.Text;
using System.Threading;
using Pacinian.Wire;
using Pacinian.Zmtp;

namespace Pacinian
{
    /// <summary>Uses .NET's sockets over TCP, and the token of a server on this machine. Needs no native library.</summary>
    public sealed class ManagedTransport : ITransport
    {
        private const double LongestWait = 0.05; // [s]: a waiting thread cannot be ended
        private const int MaxToken = 255; // [bytes] that a HELLO has room for
        private const string User = "pacinian";

        private readonly AutoResetEvent _wake = new AutoResetEvent(false);
        private readonly ZmtpSocket[] _sockets = new ZmtpSocket[3];

        /// <inheritdoc/>
        public string Open(ConnectionFile file, bool all)
        {
            Close();
            int token = Encoding.UTF8.GetByteCount(file.Token);
            if (token == 0 || token > MaxToken)
            {
                return "the connection has no token";
            }
            for (int i = 0; i < (all ? 3 : 1); i++)
            {
                string address = file.AddressOf((Channel)i);
                IPEndPoint at = Endpoint.Read(address);
                if (at == null || !IPAddress.IsLoopback(at.Address)) // a token is sent in clear text
                {
                    Close();
                    return "cannot connect to " + address + ": with a token it must be tcp://ADDRESS:PORT of this machine";
                }
                _sockets[i] = Make((Channel)i, at, file.Token);
            }
            return "";
        }

        /// <inheritdoc/>
        public Ending Ended()
        {
            ZmtpSocket ended = FindEnded();
            return ended == null ? Ending.None : ended.Ended;
        }

        /// <inheritdoc/>
        public string Problem
        {
            get
            {
                ZmtpSocket ended = FindEnded();
                return ended == null ? "" : ended.Problem;
            }
        }

        /// <inheritdoc/>
        public bool Room(Channel channel)
        {
            return _sockets[(int)channel]?.HasRoom ?? false;
        }

        /// <inheritdoc/>
        public bool Send(Channel channel, byte[] data, int count)
        {
            return _sockets[(int)channel]?.Send(data, count) ?? false;
        }

        /// <inheritdoc/>
        public int Receive(Channel channel, byte[] into)
        {
            return _sockets[(int)channel]?.Receive(into) ?? -1;
        }

        /// <inheritdoc/>
        public void Wait(double seconds)
        {
            double longest = Math.Min(Math.Max(0.0, seconds), LongestWait);
            foreach (ZmtpSocket socket in _sockets)
            {
                if (socket != null)
                {
                    socket.Watch();
                    longest = Math.Min(longest, socket.MaxWait);
                }
            }
            _wake.WaitOne((int)Math.Ceiling(1e3 * longest));
            foreach (ZmtpSocket socket in _sockets)
            {
                socket?.Work();
            }
        }

        /// <inheritdoc/>
        public void Wake()
        {
            try
            {
                _wake.Set();
            }
            catch (ObjectDisposedException)
            {
            }
        }

        /// <inheritdoc/>
        public void Close()
        {
            for (int i = 0; i < _sockets.Length; i++)
            {
                _sockets[i]?.Close();
                _sockets[i] = null;
            }
        }

        /// <inheritdoc/>
        public void Dispose()
        {
            Close();
            _wake.Dispose();
        }

        private ZmtpSocket FindEnded()
        {
            foreach (ZmtpSocket socket in _sockets)
            {
                if (socket != null && socket.Ended != Ending.None)
                {
                    return socket;
                }
            }
            return null;
        }

        private ZmtpSocket Make(Channel channel, IPEndPoint at, string token)
        {
            bool state = channel == Channel.State;
            ZmtpSettings settings = new ZmtpSettings
            {
                Kind = state ? SocketKind.Sub : SocketKind.Dealer,
                User = User,
                Password = token,
                MaxMessage = Protocol.MaxReplyBytes,
                // on other sockets, a heartbeat would wait behind unread messages
                PingInterval = channel == Channel.Control ? 1e-3 * Protocol.HeartbeatIntervalMs : 0.0,
                PingTimeout = 1e-3 * Protocol.HeartbeatTimeoutMs,
            };
            if (state)
            {
                settings.Topics.Add(Encoding.ASCII.GetBytes("state"));
            }
            return new ZmtpSocket(settings, at, state, _wake, SteadyClock.Now);
        }
    }
}
