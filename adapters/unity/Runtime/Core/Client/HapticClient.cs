using System;
using System.Collections.Generic;
using System.Threading;
using Pacinian.Wire;

namespace Pacinian
{
    /// <summary>
    /// A game's side of the wire. Nothing here waits: a worker thread owns the sockets, and what is asked is done later
    /// or, if there is no session, not at all; then the answer is false. All but <see cref="Stop"/> belongs to the game's
    /// thread, the one that calls <see cref="Tick"/>, which raises the events. Calls from another one do nothing, and that is told.
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
        private readonly Touches _touches = new Touches();
        private Standing _standing = Standing.None(ClientStatus.Stopped, "");
        private Trips _trips;
        private double _offset;
        private bool _started, _ended, _toldNoSession;
        private volatile int _thread; // that ticked last; 0: none has
        private volatile bool _toldThread;

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

        /// <summary>It does not sound any more, unasked: owner, stopped or fault; without `resume`, expired, too.</summary>
        public event Action<Refusal> Ended;

        /// <summary>What the server would not do.</summary>
        public event Action<Refusal> Refused;

        /// <summary>The server has published a state, which is good until the next tick.</summary>
        public event Action<State> StateChanged;

        /// <summary>A hand begins to feel an object of this client's scene. Touches come with the states, 60 times a second.</summary>
        public event Action<HandTouch> TouchBegan;

        /// <summary>It feels it still, where and as strongly as told.</summary>
        public event Action<HandTouch> TouchMoved;

        /// <summary>It feels it no more, as it was told last.</summary>
        public event Action<HandTouch> TouchEnded;

        /// <summary>
        /// The game stood still for longer than its lease while it was armed. It sounds again by itself if it was armed with
        /// `resume`, still owns the output, and nothing else has ended the sound.
        /// </summary>
        public event Action<Standstill> StoodStill;

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
        /// does not tick is silent when its lease is over, until it ticks again.
        /// </summary>
        public void Tick()
        {
            if (!_started || _ended)
            {
                return;
            }
            _thread = Environment.CurrentManagedThreadId;
            double still, worker;
            _shared.Heartbeat.Tick(Now, out still, out worker);
            _worker.Wake();
            if (Armed && still > Lease)
            {
                StoodStill?.Invoke(new Standstill { Seconds = still, Whole = worker > 0.75 * still });
            }
            bool fresh = _shared.Inbox.Look(out _standing, out _trips, out _offset);
            Notice notice;
            while (!_ended && _shared.Inbox.Take(out notice, ref _standing))
            {
                Raise(notice);
            }
            if (fresh && !_ended)
            {
                Follow(State.Scene == Scene ? State : null);
                StateChanged?.Invoke(State);
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

        private void Follow(State state)
        {
            _touches.Follow(state, TouchBegan, TouchMoved, TouchEnded);
        }

        private void Raise(Notice notice)
        {
            switch (notice.What)
            {
                case Happening.Connected: _toldNoSession = false; Connected?.Invoke(); break;
                case Happening.Lost: Follow(null); Lost?.Invoke(notice.Why.Message); break;
                case Happening.Ended: Ended?.Invoke(notice.Why); break;
                case Happening.Refused: Refused?.Invoke(notice.Why); break;
                case Happening.Answered: notice.Callback(notice.Answer); break;
            }
        }
    }
}
