using System;
using System.Collections.Generic;
using System.Threading;
using Pacinian.Wire;

namespace Pacinian
{
    /// <summary>
    /// A game's side of the wire. Nothing here waits: a worker thread owns the sockets, and what is asked is done later
    /// or, if there is no session, not at all; then the answer is false. All but <see cref="Stop"/> belongs to the game's
    /// thread, on which events are raised, too, by <see cref="Tick"/>.
    ///
    /// It connects by itself, again and again. After a loss nothing resumes: the output is not armed, and what was put is
    /// to be put again, best when <see cref="Connected"/> is raised.
    /// </summary>
    public sealed partial class HapticClient : IDisposable
    {
        private const double End = 0.5; // [s] that the end may take

        private readonly SharedState _shared;
        private readonly Worker _worker;
        private readonly List<Thread> _stops = new List<Thread>();
        private Standing _standing = Standing.None(ClientStatus.Stopped, "");
        private Trips _trips;
        private double _offset;
        private bool _started, _ended;

        /// <summary>Not started yet.</summary>
        public HapticClient(Options options)
        {
            _shared = new SharedState(options);
            _worker = new Worker(_shared);
        }

        /// <summary>One that is forgotten ends by itself.</summary>
        ~HapticClient()
        {
            _worker?.End();
        }

        /// <summary>There is a session: now put what is to be felt.</summary>
        public event Action Connected;

        /// <summary>The session is over, and why: nothing of it goes on.</summary>
        public event Action<string> Lost;

        /// <summary>It does not sound any more, unasked: expired, owner, stopped or fault.</summary>
        public event Action<Refusal> Ended;

        /// <summary>What the server would not do.</summary>
        public event Action<Refusal> Refused;

        /// <summary>The server has published a state, which is good until the next tick.</summary>
        public event Action<State> StateChanged;

        /// <summary>Begins to connect.</summary>
        public void Start()
        {
            if (!_started && !_ended)
            {
                _started = true;
                _standing = Standing.None(ClientStatus.Connecting, "");
                _shared.Inbox.Stand(_standing);
                _worker.Start();
            }
        }

        /// <summary>
        /// Once in each of the game's frames: it is alive, so the lease goes on; what has happened is told. A game that
        /// does not tick is silent when its lease is over.
        /// </summary>
        public void Tick()
        {
            if (!_started || _ended)
            {
                return;
            }
            _shared.Heartbeat.LastTick = Now;
            _worker.Wake();
            bool fresh = _shared.Inbox.Look(out _standing, out _trips, out _offset);
            Notice notice;
            while (!_ended && _shared.Inbox.Take(out notice, ref _standing))
            {
                Raise(notice);
            }
            if (fresh && !_ended && StateChanged != null)
            {
                StateChanged(State);
            }
        }

        /// <summary>Says goodbye, and ends: silence, if this client owns the output. Takes half a second at most.</summary>
        public void Dispose()
        {
            if (_ended)
            {
                return;
            }
            _ended = true;
            GC.SuppressFinalize(this);
            double due = Timing.Now() + End;
            _worker.End();
            _worker.Join(Left(due));
            lock (_stops)
            {
                foreach (Thread stop in _stops)
                {
                    stop.Join(Left(due));
                }
            }
            _standing = Standing.None(ClientStatus.Stopped, _shared.Inbox.Standing.Problem);
        }

        private static int Left(double due)
        {
            return (int)Math.Max(0.0, 1e3 * (due - Timing.Now()));
        }

        private void Raise(Notice notice)
        {
            switch (notice.What)
            {
                case Happening.Connected: Connected?.Invoke(); break;
                case Happening.Lost: Lost?.Invoke(notice.Why.Message); break;
                case Happening.Ended: Ended?.Invoke(notice.Why); break;
                case Happening.Refused: Refused?.Invoke(notice.Why); break;
                case Happening.Answered: notice.Callback(notice.Answer); break;
            }
        }
    }
}
