#if PACINIAN_NETMQ
using System;
using System.Threading;
using NetMQ;
using NetMQ.Sockets;

namespace Pacinian
{
    /// <summary>
    /// Uses NetMQ 4.0.1.6 or newer over TCP, for platforms without a native library. It supports only CURVE keys, because
    /// NetMQ has no PLAIN. It does not report why a server refuses, and allocates for each message. On Windows, call
    /// AsyncIO.ForceDotNet.Force() first.
    /// </summary>
    public sealed class NetMqTransport : ITransport
    {
        private static readonly TimeSpan Never = TimeSpan.FromDays(1);

        private readonly NetMQSocket[] _sockets = new NetMQSocket[3];
        private readonly NetMQSelector _selector = new NetMQSelector();
        private readonly NetMQSelector.Item[] _items = new NetMQSelector.Item[4];
        private readonly bool[] _full = new bool[3];
        private readonly object _waking = new object();
        private readonly byte[] _wake = new byte[1];
        private PairSocket _wakes, _woken;
        private bool _stood;
        private int _rung;

        /// <summary>Creates a transport that is not connected.</summary>
        public NetMqTransport()
        {
            PairSocket.CreateSocketPair(out _wakes, out _woken);
        }

        /// <inheritdoc/>
        public string Open(ConnectionFile file, bool all)
        {
            Close();
            byte[] server, ours, secret;
            if (!Z85.Read(file.ServerKey, out server) || !Z85.Read(file.PublicKey, out ours)
                || !Z85.Read(file.SecretKey, out secret))
            {
                return "NetMQ knows no tokens (PLAIN), only CURVE keys";
            }
            try
            {
                for (int i = 0; i < (all ? 3 : 1); i++)
                {
                    SubscriberSocket states = i == (int)Channel.State ? new SubscriberSocket() : null;
                    NetMQSocket socket = (NetMQSocket)states ?? new DealerSocket();
                    _sockets[i] = socket;
                    socket.Options.Linger = TimeSpan.Zero;
                    socket.Options.MaxMsgSize = Wire.Protocol.MaxReplyBytes;
                    socket.Options.CurveServerKey = server;
                    socket.Options.CurveCertificate = new NetMQCertificate(secret, ours);
                    if (states != null)
                    {
                        states.Subscribe("state");
                    }
                    else
                    {
                        socket.Options.SendHighWatermark = 16;
                        socket.Options.DelayAttachOnConnect = true;
                        socket.Options.ReconnectInterval = Never;
                        socket.Options.HeartbeatInterval = TimeSpan.FromMilliseconds(i == 0 ? Wire.Protocol.HeartbeatIntervalMs : 0);
                        socket.Options.HeartbeatTimeout = TimeSpan.FromMilliseconds(Wire.Protocol.HeartbeatTimeoutMs);
                    }
                    socket.Connect(file.AddressOf((Channel)i));
                }
            }
            catch (Exception error) when (error is NetMQException || error is ArgumentException)
            {
                Close();
                return "cannot connect to " + file.Control + ": " + error.Message;
            }
            return "";
        }

        /// <summary>Returns how the connection has ended. It counts as gone once its control socket has no room any more.</summary>
        public Ending Ended()
        {
            NetMQSocket control = _sockets[0];
            bool room = control != null && control.HasOut;
            _stood |= room;
            return _stood && !room ? Ending.Gone : Ending.None;
        }

        /// <inheritdoc/>
        public string Problem
        {
            get { return ""; } // NetMQ does not report it
        }

        /// <inheritdoc/>
        public bool Room(Channel channel)
        {
            NetMQSocket socket = _sockets[(int)channel];
            bool room = socket != null && socket.HasOut;
            _full[(int)channel] = !room;
            return room;
        }

        /// <inheritdoc/>
        public bool Send(Channel channel, byte[] data, int count)
        {
            NetMQSocket socket = _sockets[(int)channel];
            bool sent = socket != null && socket.TrySendFrame(TimeSpan.Zero, data, count);
            _full[(int)channel] = !sent;
            return sent;
        }

        /// <inheritdoc/>
        public int Receive(Channel channel, byte[] into)
        {
            NetMQSocket socket = _sockets[(int)channel];
            byte[] part;
            bool more;
            if (socket == null || !socket.TryReceiveFrameBytes(out part, out more))
            {
                return -1;
            }
            while (more)
            {
                socket.TryReceiveFrameBytes(Never, out part, out more); // all parts of a message arrive together
            }
            int count = Math.Min(part.Length, into.Length);
            Buffer.BlockCopy(part, 0, into, 0, count);
            return count;
        }

        /// <inheritdoc/>
        public void Wait(double seconds)
        {
            int count = 0;
            _items[count++] = new NetMQSelector.Item(_woken, PollEvents.PollIn);
            for (int i = 0; i < 3; i++)
            {
                if (_sockets[i] != null)
                {
                    PollEvents wanted = _full[i] ? PollEvents.PollIn | PollEvents.PollOut : PollEvents.PollIn;
                    _items[count++] = new NetMQSelector.Item(_sockets[i], wanted);
                    _full[i] = false;
                }
            }
            _selector.Select(_items, count, (long)Math.Ceiling(1e3 * Math.Max(0.0, Math.Min(seconds, 0.05))));
            byte[] wake;
            bool more;
            while (_woken.TryReceiveFrameBytes(out wake, out more))
            {
            }
            Interlocked.Exchange(ref _rung, 0);
        }

        /// <inheritdoc/>
        public void Wake()
        {
            if (Interlocked.Exchange(ref _rung, 1) == 0)
            {
                lock (_waking)
                {
                    if (_wakes != null)
                    {
                        _wakes.TrySendFrame(TimeSpan.Zero, _wake, 1);
                    }
                }
            }
        }

        /// <inheritdoc/>
        public void Close()
        {
            _stood = false;
            for (int i = 0; i < 3; i++)
            {
                if (_sockets[i] != null)
                {
                    _sockets[i].Dispose();
                    _sockets[i] = null;
                }
            }
        }

        /// <inheritdoc/>
        public void Dispose()
        {
            Close();
            lock (_waking)
            {
                if (_wakes != null)
                {
                    _wakes.Dispose();
                    _woken.Dispose();
                    _wakes = null;
                }
            }
        }
    }
}
#endif
