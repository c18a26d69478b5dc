using System;

namespace Pacinian
{
    /// <summary>
    /// One session after another: connects, again and again with growing pauses, and takes nothing of a session that
    /// was lost into the next. Pure: times are given, and it never waits.
    /// </summary>
    internal sealed class Sessions
    {
        private const double Shortest = 0.1, Longest = 2.0; // [s] of the pauses
        private const double Unasked = 0.5; // [s] of the longest pause if nobody was asked: a look at a file costs little
        private const double Asleep = 0.05; // [s] between two looks at what brings no message

        private readonly SharedState _shared;
        private readonly ITransport _transport;
        private readonly ConnectionReader _read;
        private readonly MessageBuffers _buffers;
        private ServerSession _session;
        private double _due = double.NegativeInfinity, _pause = Shortest / 2.0;
        private int _count;

        /// <summary>read: reads the connection file.</summary>
        public Sessions(SharedState shared, ITransport transport, ConnectionReader read)
        {
            _shared = shared;
            _transport = transport;
            _read = read;
            _buffers = new MessageBuffers(shared.Options.Life);
        }

        /// <summary>Does what is due. ticked: when the game ticked last; both [s].</summary>
        public void Step(double now, double ticked)
        {
            if (_session == null && now >= _due)
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
                Pause(_session.Over, _session.Refused, _session.Begun, Longest, now);
            }
        }

        /// <summary>How long there is nothing to do but what comes [s].</summary>
        public double Patience(double now)
        {
            return _session != null ? Asleep : Math.Max(0.0, Math.Min(Asleep, _due - now));
        }

        /// <summary>Says goodbye, if there is a session; whether there will be an answer.</summary>
        public bool Leave(double now)
        {
            return _session != null && _session.Leave(now);
        }

        /// <summary>Whether the goodbye was answered, or there is nobody any more who would.</summary>
        public bool Left
        {
            get { return _session == null || _session.Left; }
        }

        private void Connect(double now)
        {
            string problem;
            ConnectionFile file = _read(_shared.Options.ConnectionPath, out problem);
            if (problem.Length == 0)
            {
                problem = _transport.Open(file, true);
            }
            if (problem.Length > 0)
            {
                Pause(problem, false, false, Unasked, now);
                return;
            }
            _session = new ServerSession(_shared, _transport, _buffers, file.Control, ++_count, now);
        }

        private void Pause(string problem, bool refused, bool begun, double longest, double now)
        {
            _transport.Close();
            _session = null;
            _pause = begun ? Shortest : Math.Min(2.0 * _pause, longest);
            _due = now + _pause;
            _shared.End(problem, refused, begun);
        }
    }
}
