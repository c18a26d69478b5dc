using System;
using System.Net.Sockets;
using System.Threading;

namespace Pacinian.Zmtp
{
    /// <summary>
    /// A thread that waits until a socket has something to read, and then sets a wake event. It replaces Socket.Select,
    /// which allocates at each call.
    /// </summary>
    internal sealed class ReadWatcher
    {
        private const int PollTime = 50000; // [us] of a wait: a thread in native code cannot be ended
        private const int JoinTimeout = 1000; // [ms]; only a thread that hangs takes so long

        private readonly Socket _socket;
        private readonly AutoResetEvent _wake, _armed = new AutoResetEvent(false);
        private readonly Thread _thread;
        private volatile bool _watches, _ends;

        public ReadWatcher(Socket socket, AutoResetEvent wake)
        {
            _socket = socket;
            _wake = wake;
            _thread = new Thread(Run) { IsBackground = true, Name = "Pacinian reading" };
            _thread.Start();
        }

        /// <summary>Requests that the wake event be set once, now or when something arrives.</summary>
        public void Arm()
        {
            if (!_watches)
            {
                _watches = true;
                _armed.Set();
            }
        }

        /// <summary>Ends the thread. The caller must have shut down the socket, which ends the wait.</summary>
        public void End()
        {
            _ends = true;
            _armed.Set();
            if (_thread.Join(JoinTimeout))
            {
                _armed.Dispose();
            }
        }

        private void Run()
        {
            try
            {
                for (_armed.WaitOne(); !_ends; _armed.WaitOne())
                {
                    while (!_ends && !_socket.Poll(PollTime, SelectMode.SelectRead))
                    {
                    }
                    _watches = false;
                    _wake.Set();
                }
            }
            catch (Exception error) when (error is SocketException || error is ObjectDisposedException)
            {
            }
        }
    }
}
