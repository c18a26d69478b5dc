using System;

namespace Pacinian
{
    /// <summary>
    /// Runs one session after another. Reconnects with growing pauses, and carries nothing of a lost session into the
    /// next. Never blocks, and does not read a clock: times are arguments.
    /// </summary>
    internal sealed class SessionLoop
    {
        private const double IdlePollInterval = 0.05; // [s] longest time between two calls of Step if no message arrives

        private readonly SharedState _shared;
        private readonly ITransport _transport;
        private readonly ConnectionReader _read;
        private readonly MessageBuffers _buffers;
        private readonly ReconnectBackoff _backoff = new ReconnectBackoff();
        private ServerSession _session;
        private int _count;

        /// <summary>read: reads the connection file.</summary>
        public SessionLoop(SharedState shared, ITransport transport, ConnectionReader read)
        {
            _shared = shared;
            _transport = transport;
            _read = read;
            _buffers = new MessageBuffers(shared.Options.Life);
        }

        /// <summary>Connects, or runs the session. ticked: the time of the game's last tick; both [s].</summary>
        public void Step(double now, double ticked)
        {
            if (_session == null && now >= _backoff.Due)
            {
                Connect(now);
            }
            if (_session == null)
            {
                return;
            }
            _session.Step(now, ticked);
            if (_session.Over.Length > 0)
            {
                ScheduleRetry(_session.Over, _session.Refused, _session.Begun, ReconnectBackoff.MaxPause, now);
            }
        }

        /// <summary>Returns the time after which Step must be called even if no message has arrived [s].</summary>
        public double MaxWait(double now)
        {
            return _session != null ? IdlePollInterval : Math.Max(0.0, Math.Min(IdlePollInterval, _backoff.Due - now));
        }

        /// <summary>Says goodbye if there is a session. Returns whether an answer will come.</summary>
        public bool SayGoodbye(double now)
        {
            return _session != null && _session.SayGoodbye(now);
        }

        /// <summary>Whether the goodbye was answered, or no server can answer it.</summary>
        public bool GoodbyeAnswered
        {
            get { return _session == null || _session.GoodbyeAnswered; }
        }

        private void Connect(double now)
        {
            string problem = ErrorMessages.WrongOption(_shared.Options);
            if (problem.Length > 0)
            {
                ScheduleRetry(problem, true, false, ReconnectBackoff.MaxPauseWithoutServer, now);
                return;
            }
            ConnectionFile file = _read(_shared.Options.ConnectionPath, out problem);
            if (problem.Length == 0)
            {
                problem = _transport.Open(file, true);
            }
            if (problem.Length > 0)
            {
                ScheduleRetry(problem, false, false, ReconnectBackoff.MaxPauseWithoutServer, now);
                return;
            }
            _session = new ServerSession(_shared, _transport, _buffers, file.Control, ++_count, now);
        }

        private void ScheduleRetry(string problem, bool refused, bool begun, double maxPause, double now)
        {
            _transport.Close();
            _session = null;
            if (begun)
            {
                _backoff.RecordSuccess();
            }
            _backoff.RecordFailure(problem, now, maxPause);
            _shared.EndSession(problem, refused, begun);
        }
    }
}
