using System;
using System.Threading;

namespace Pacinian
{
    /// <summary>Uses libzmq with CURVE keys, for a server on another machine.</summary>
    public sealed class ZmqTransport : ITransport
    {
        private const int MaxWait = 50; // [ms] of a wait: a thread in native code cannot be ended
        private static int _counted;

        private readonly object _waking = new object();
        private readonly byte[] _wake = new byte[1];
        private readonly ZmqPoll _poll = new ZmqPoll(6);
        private readonly ZmqSocket[] _sockets = new ZmqSocket[3];
        private IntPtr _context;
        private ZmqSocket _wakes, _woken;
        private Ending _ending;
        private int _rung;

        /// <summary>Creates a transport. Raises DllNotFoundException if libzmq is not installed.</summary>
        public ZmqTransport()
        {
            try
            {
                _context = LibZmq.zmq_ctx_new();
                byte[] at = LibZmq.Text("inproc://wake");
                _woken = new ZmqSocket(_context, LibZmq.Pair);
                _wakes = new ZmqSocket(_context, LibZmq.Pair);
                LibZmq.zmq_bind(_woken.Handle, at);
                LibZmq.zmq_connect(_wakes.Handle, at);
            }
            catch
            {
                _poll.Dispose();
                throw;
            }
        }

        /// <inheritdoc/>
        public string Open(ConnectionFile file, bool all)
        {
            Close();
            _ending = Ending.None;
            for (int i = 0; i < (all ? 3 : 1); i++)
            {
                Channel channel = (Channel)i;
                bool state = channel == Channel.State;
                ZmqSocket socket = new ZmqSocket(_context, state ? LibZmq.Subscriber : LibZmq.Dealer);
                _sockets[i] = socket;
                string problem = Begin(socket, channel, file);
                if (problem.Length > 0)
                {
                    Close();
                    return problem;
                }
            }
            return "";
        }

        /// <inheritdoc/>
        public Ending Ended()
        {
            foreach (ZmqSocket socket in _sockets)
            {
                if (socket != null && _ending == Ending.None)
                {
                    _ending = socket.Ended();
                }
            }
            return _ending;
        }

        /// <inheritdoc/>
        public string Problem
        {
            get { return ""; } // libzmq does not report it
        }

        /// <inheritdoc/>
        public bool Room(Channel channel)
        {
            return _sockets[(int)channel]?.Room() ?? false;
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
            Listen();
            int milliseconds = (int)Math.Ceiling(1e3 * Math.Max(0.0, seconds));
            if (!_poll.Wait(Math.Min(milliseconds, MaxWait)))
            {
                Thread.Sleep(1);
            }
            foreach (ZmqSocket socket in _sockets)
            {
                if (socket != null)
                {
                    socket.Full = false;
                }
            }
            while (_woken.Receive(_wake) >= 0)
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
                    if (_wakes.Valid)
                    {
                        _wakes.Send(_wake, 1);
                    }
                }
            }
        }

        /// <inheritdoc/>
        public void Close()
        {
            for (int i = 0; i < 3; i++)
            {
                _sockets[i]?.Close();
                _sockets[i] = null;
            }
        }

        /// <inheritdoc/>
        public void Dispose()
        {
            if (_context == IntPtr.Zero)
            {
                return;
            }
            Close();
            lock (_waking)
            {
                _wakes.Close();
            }
            _woken.Close();
            _poll.Dispose();
            LibZmq.zmq_ctx_term(_context);
            _context = IntPtr.Zero;
        }

        private string Begin(ZmqSocket socket, Channel channel, ConnectionFile file)
        {
            if (!socket.Valid)
            {
                return "libzmq gives no more sockets";
            }
            if (!socket.Secure(file))
            {
                return "the connection has no keys of a client";
            }
            if (channel == Channel.State)
            {
                socket.Set(LibZmq.Subscribe, "state");
            }
            else
            {
                string monitor = "inproc://monitor" + Interlocked.Increment(ref _counted);
                socket.Once(_context, monitor, channel == Channel.Control);
            }
            string at = file.AddressOf(channel);
            return socket.Connect(at) ? "" : "cannot connect to " + at;
        }

        private void Listen()
        {
            _poll.Clear();
            _poll.Add(_woken.Handle, false);
            foreach (ZmqSocket socket in _sockets)
            {
                if (socket != null)
                {
                    _poll.Add(socket.Handle, socket.Full);
                    if (socket.Monitor != IntPtr.Zero)
                    {
                        _poll.Add(socket.Monitor, false);
                    }
                }
            }
        }
    }
}
