using System;
using System.Net;
using System.Threading;

namespace Pacinian.Zmtp
{
    /// <summary>
    /// A DEALER or SUB socket with one peer, to which it connects. Belongs to one thread and never waits: <see cref="Work"/>
    /// is to be called again when the wake event is set, and at the latest after <see cref="Patience"/>.
    /// </summary>
    internal sealed class ZmtpSocket
    {
        private const double FirstPause = 0.1, LongestPause = 2.0; // [s] before it connects again
        private const double PollInterval = 0.002; // [s] between two looks at what sets no wake event: a connection, and room to send
        private const int MaxReads = 16; // of a peer that sends without an end, for one message

        private readonly ZmtpSettings _settings;
        private readonly IPEndPoint _at;
        private readonly AutoResetEvent _wake;
        private readonly Func<double> _clock;
        private readonly bool _reconnects;
        private TcpLink _link;
        private ZmtpConnection _connection;
        private double _begun, _due = double.NegativeInfinity, _pause = FirstPause;
        private Ending _unconnected;

        /// <summary>Begins to connect. reconnects: again and again; else its end is its end. clock [s].</summary>
        public ZmtpSocket(ZmtpSettings settings, IPEndPoint at, bool reconnects, AutoResetEvent wake, Func<double> clock)
        {
            _settings = settings;
            _at = at;
            _reconnects = reconnects;
            _wake = wake;
            _clock = clock;
            Work();
        }

        /// <summary>How it has ended; never if it reconnects.</summary>
        public Ending Ended
        {
            get { return _reconnects ? Ending.None : Current; }
        }

        /// <summary>Why it has ended, for people; "" if the peer has just closed it.</summary>
        public string Problem
        {
            get { return _connection == null ? "" : _connection.Problem; }
        }

        /// <summary>Whether a message can be sent now.</summary>
        public bool HasRoom
        {
            get { return _connection != null && _connection.HasRoom; }
        }

        /// <summary>How long it can be left alone unless the wake event is set [s].</summary>
        public double Patience
        {
            get
            {
                if (_link == null || Current != Ending.None)
                {
                    return _reconnects ? Math.Max(0.0, _due - _clock()) : double.PositiveInfinity;
                }
                if (_connection != null && _connection.Established && _connection.Input.IsUnread)
                {
                    return 0.0; // it was read from TCP, so that no wake event is set for it
                }
                bool looks = _connection == null || _connection.Output.Count > 0;
                return looks ? PollInterval : _settings.PingInterval > 0.0 ? _settings.PingInterval : double.PositiveInfinity;
            }
        }

        private Ending Current
        {
            get { return _connection == null ? _unconnected : _connection.Ending; }
        }

        /// <summary>Does what is due: connects, shakes hands, sends what waits, and heartbeats.</summary>
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

        /// <summary>Takes a message; false if there is no room for it.</summary>
        public bool Send(byte[] data, int count)
        {
            bool sent = _connection != null && _connection.Send(data, count);
            if (sent)
            {
                _link.Write(_connection.Output);
            }
            return sent;
        }

        /// <summary>The last part of the next message: its bytes; -1 if there is none.</summary>
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

        /// <summary>Asks for messages that begin so, now and after each reconnection.</summary>
        public void Subscribe(byte[] topic)
        {
            _settings.Topics.Add(topic);
            SendSubscription(topic, true);
        }

        /// <summary>Asks once less for messages that begin so.</summary>
        public void Cancel(byte[] topic)
        {
            if (_settings.Remove(topic))
            {
                SendSubscription(topic, false);
            }
        }

        /// <summary>The wake event is to be set when something comes.</summary>
        public void Watch()
        {
            if (_link != null && Current == Ending.None)
            {
                _link.Watch();
            }
        }

        /// <summary>Closes it at once; what was not sent is not sent any more.</summary>
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

        /// <summary>now: before the last bytes were read.</summary>
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

        private void SendSubscription(byte[] topic, bool wanted)
        {
            if (_connection != null && _connection.Established && Current == Ending.None)
            {
                _connection.Subscribe(topic, wanted);
                _link.Write(_connection.Output);
            }
        }
    }
}
