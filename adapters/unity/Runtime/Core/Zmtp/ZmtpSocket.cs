using System;
using System.Net;
using System.Threading;

namespace Pacinian.Zmtp
{
    /// <summary>
    /// A DEALER or SUB socket that connects to one peer. Belongs to one thread and never blocks. Call <see
    /// cref="Work"/> again when the wake event is set, and at the latest after <see cref="MaxWait"/>.
    /// </summary>
    internal sealed class ZmtpSocket
    {
        private const double FirstPause = 0.1, LongestPause = 2.0; // [s] before it connects again
        private const double PollInterval = 0.002; // [s] between two checks of what sets no wake event: connecting, and room to send
        private const int MaxReads = 16; // for one message, of a peer that sends without end

        private readonly ZmtpSettings _settings;
        private readonly IPEndPoint _at;
        private readonly AutoResetEvent _wake;
        private readonly Func<double> _clock;
        private readonly bool _reconnects;
        private TcpLink _link;
        private ZmtpConnection _connection;
        private double _begun, _due = double.NegativeInfinity, _pause = FirstPause;
        private Ending _unconnected;

        /// <summary>Starts to connect. reconnects: whether it connects again after each end. clock: [s].</summary>
        public ZmtpSocket(ZmtpSettings settings, IPEndPoint at, bool reconnects, AutoResetEvent wake, Func<double> clock)
        {
            _settings = settings;
            _at = at;
            _reconnects = reconnects;
            _wake = wake;
            _clock = clock;
            Work();
        }

        /// <summary>How the connection has ended; Ending.None if the socket reconnects.</summary>
        public Ending Ended
        {
            get { return _reconnects ? Ending.None : Current; }
        }

        /// <summary>Why the connection has ended, for people; "" if the peer closed it.</summary>
        public string Problem
        {
            get { return _connection == null ? "" : _connection.Problem; }
        }

        /// <summary>Whether a message can be sent now.</summary>
        public bool HasRoom
        {
            get { return _connection != null && _connection.HasRoom; }
        }

        /// <summary>The time after which Work must be called even if the wake event is not set [s].</summary>
        public double MaxWait
        {
            get
            {
                if (_link == null || Current != Ending.None)
                {
                    return _reconnects ? Math.Max(0.0, _due - _clock()) : double.PositiveInfinity;
                }
                if (_connection != null && _connection.Established && _connection.Input.IsUnread)
                {
                    return 0.0; // already read from TCP, so no wake event is set for it
                }
                bool looks = _connection == null || _connection.Output.Count > 0;
                return looks ? PollInterval : _settings.PingInterval > 0.0 ? _settings.PingInterval : double.PositiveInfinity;
            }
        }

        private Ending Current
        {
            get { return _connection == null ? _unconnected : _connection.Ending; }
        }

        /// <summary>Connects, shakes hands, and sends waiting messages and heartbeats, as far as they are due.</summary>
        public void Work()
        {
            double now = _clock();
            if (_link == null && now >= _due)
            {
                Connect(now);
            }
            if (_link == null || Current != Ending.None)
            {
                return;
            }
            if (_connection == null)
            {
                _link.TryConnect();
                if (_link.Closed || !_link.Connected && now - _begun > _settings.ConnectTimeout)
                {
                    End(Ending.Nobody, now);
                    return;
                }
                if (!_link.Connected)
                {
                    return;
                }
                _connection = new ZmtpConnection(_settings, now);
            }
            ReadBytes(now);
            Continue(now);
        }

        /// <summary>Takes a message. Returns false if there is no room.</summary>
        public bool Send(byte[] data, int count)
        {
            bool sent = _connection != null && _connection.Send(data, count);
            if (sent)
            {
                _link.Write(_connection.Output);
            }
            return sent;
        }

        /// <summary>Receives the last part of the next message. Returns its length; -1 if there is none.</summary>
        public int Receive(byte[] into)
        {
            if (_connection == null)
            {
                return -1;
            }
            int count = _connection.Read(into);
            for (int i = 0; i < MaxReads && count < 0 && Current == Ending.None; i++)
            {
                double now = _clock();
                bool some = ReadBytes(now);
                count = _connection.Read(into);
                if (count < 0)
                {
                    Continue(now);
                }
                if (!some)
                {
                    break;
                }
            }
            return count;
        }

        /// <summary>Requests that the wake event be set when something arrives.</summary>
        public void Watch()
        {
            if (_link != null && Current == Ending.None)
            {
                _link.Watch();
            }
        }

        /// <summary>Closes the socket at once. Messages that were not sent are dropped.</summary>
        public void Close()
        {
            if (_link != null)
            {
                _link.Close();
                _link = null;
            }
            _connection = null;
            _due = double.PositiveInfinity;
        }

        private void Connect(double now)
        {
            _connection = null;
            _unconnected = Ending.None;
            _begun = now;
            _link = new TcpLink(_at, _wake);
        }

        private bool ReadBytes(double now)
        {
            bool some = _link.Read(_connection.Input);
            if (some)
            {
                _connection.NoteArrival(now);
            }
            return some;
        }

        /// <summary>now: the time before the last bytes were read.</summary>
        private void Continue(double now)
        {
            _connection.Advance();
            _connection.CheckTime(now);
            _link.Write(_connection.Output);
            if (_link.Closed)
            {
                _connection.NoteClosed();
            }
            if (_connection.Established)
            {
                _pause = FirstPause;
            }
            if (_connection.Ending != Ending.None)
            {
                End(_connection.Ending, now);
            }
        }

        private void End(Ending ending, double now)
        {
            _unconnected = ending;
            if (_reconnects)
            {
                _link.Close();
                _link = null;
                _due = now + _pause;
                _pause = Math.Min(2.0 * _pause, LongestPause);
            }
        }
    }
}
