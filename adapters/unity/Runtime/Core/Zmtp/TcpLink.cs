using System;
using System.Net;
using System.Net.Sockets;
using System.Threading;

namespace Pacinian.Zmtp
{
    /// <summary>A TCP connection that neither blocks nor throws. Belongs to one thread.</summary>
    internal sealed class TcpLink
    {
        /// <summary>
        /// The number of bytes sent at once. Mono's Send loops without a pause until all is sent, even for a
        /// non-blocking socket. Therefore it gets only as much as every system has room for once a socket is writable.
        /// </summary>
        private const int Chunk = 2048;

        private const int MaxReads = 16; // for a peer that sends without end

        private readonly AutoResetEvent _wake;
        private readonly Socket _socket;
        private ReadWatcher _watcher;
        private bool _broken; // nothing can be sent; received bytes can still be read

        /// <summary>Starts to connect. wake: is set when something has arrived, after <see cref="Watch"/>.</summary>
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

        /// <summary>Whether the connection was established.</summary>
        public bool Connected { get; private set; }

        /// <summary>Whether the connection failed, or the peer has closed it and all received bytes were read.</summary>
        public bool Closed { get; private set; }

        /// <summary>Checks whether the connection is established by now.</summary>
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

        /// <summary>Reads received bytes. Returns whether there were any.</summary>
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

        /// <summary>Requests that the wake event be set once, now or when something arrives.</summary>
        public void Watch()
        {
            if (Connected && !Closed)
            {
                _watcher = _watcher ?? new ReadWatcher(_socket, _wake);
                _watcher.Arm();
            }
        }

        /// <summary>Closes the connection at once, and ends its thread.</summary>
        public void Close()
        {
            Closed = true;
            if (_watcher != null)
            {
                try
                {
                    _socket.Shutdown(SocketShutdown.Both);
                }
                catch (SocketException) // the peer closed first
                {
                }
                _watcher.End();
                _watcher = null;
            }
            _socket?.Close();
        }
    }
}
