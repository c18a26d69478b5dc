using System;
using System.Net;
using System.Net.Sockets;
using System.Threading;

namespace Pacinian.Zmtp
{
    /// <summary>A TCP connection that never waits, and does not raise. Belongs to one thread.</summary>
    internal sealed class TcpLink
    {
        /// <summary>
        /// [bytes] that are sent at once. Mono's Send goes round without a pause until all is sent, also of a socket that does
        /// not wait; so it is given only what every system has room for once it says that there is some.
        /// </summary>
        private const int Chunk = 2048;

        private const int MaxReads = 16; // at once, of a peer that sends without an end

        private readonly AutoResetEvent _wake;
        private readonly Socket _socket;
        private ReadWatcher _watcher;
        private bool _broken; // nothing can be sent; what has come can still be read

        /// <summary>Begins to connect. wake: is set when something has come, after <see cref="Watch"/>.</summary>
        public TcpLink(IPEndPoint at, AutoResetEvent wake)
        {
            _wake = wake;
            try
            {
                _socket = new Socket(at.AddressFamily, SocketType.Stream, ProtocolType.Tcp) { Blocking = false, NoDelay = true };
                _socket.Connect(at);
            }
            catch (SocketException error)
            {
                Closed = error.SocketErrorCode != SocketError.WouldBlock && error.SocketErrorCode != SocketError.InProgress;
            }
        }

        /// <summary>Whether it was connected.</summary>
        public bool Connected { get; private set; }

        /// <summary>Whether it could not be connected, or the peer has closed it and all that came is read.</summary>
        public bool Closed { get; private set; }

        /// <summary>Looks whether it is connected by now.</summary>
        public void TryConnect()
        {
            if (Connected || Closed)
            {
                return;
            }
            try
            {
                bool failed = _socket.Poll(0, SelectMode.SelectError);
                if (failed || _socket.Poll(0, SelectMode.SelectWrite))
                {
                    object error = _socket.GetSocketOption(SocketOptionLevel.Socket, SocketOptionName.Error);
                    Connected = !failed && (int)error == 0;
                    Closed = !Connected;
                }
            }
            catch (SocketException)
            {
                Closed = true;
            }
        }

        /// <summary>Takes in what has come; whether that was something.</summary>
        public bool Read(FrameReader input)
        {
            bool some = false;
            for (int i = 0; i < MaxReads && Connected && !Closed; i++)
            {
                int offset, room = input.Reserve(out offset);
                if (room == 0)
                {
                    break;
                }
                SocketError error;
                int count = _socket.Receive(input.Data, offset, room, SocketFlags.None, out error);
                if (count > 0)
                {
                    input.Add(count);
                    some = true;
                }
                else
                {
                    Closed = _broken || error != SocketError.WouldBlock && error != SocketError.Interrupted;
                    break;
                }
                if (count < room)
                {
                    break;
                }
            }
            return some;
        }

        /// <summary>Sends as much as there is room for.</summary>
        public void Write(FrameWriter output)
        {
            try
            {
                while (output.Count > 0 && Connected && !_broken && !Closed && _socket.Poll(0, SelectMode.SelectWrite))
                {
                    SocketError error;
                    int count = Math.Min(output.Count, Chunk);
                    count = _socket.Send(output.Data, output.Offset, count, SocketFlags.None, out error);
                    output.MarkSent(count);
                    if (count <= 0)
                    {
                        _broken = error != SocketError.WouldBlock && error != SocketError.Interrupted;
                        return;
                    }
                }
            }
            catch (SocketException)
            {
                _broken = true;
            }
        }

        /// <summary>The wake event is to be set once, now or when something comes.</summary>
        public void Watch()
        {
            if (Connected && !Closed)
            {
                _watcher = _watcher ?? new ReadWatcher(_socket, _wake);
                _watcher.Arm();
            }
        }

        /// <summary>Closes it at once; its thread has ended then.</summary>
        public void Close()
        {
            Closed = true;
            if (_watcher != null)
            {
                try
                {
                    _socket.Shutdown(SocketShutdown.Both);
                }
                catch (SocketException) // the peer was faster
                {
                }
                _watcher.End();
                _watcher = null;
            }
            _socket?.Close();
        }
    }
}
