using System;
using System.Collections.Generic;
using System.Threading;
using Pacinian.Wire;

namespace Pacinian
{
    /// <summary>
    /// A client of the server. No call blocks: a worker thread owns the sockets and sends commands later. Without a
    /// session, commands return false and are not sent. All members except <see cref="Stop"/> belong to the game's
    /// thread, which calls <see cref="Tick"/>; Tick raises the events. Calls from another thread do nothing and are
    /// reported.
    /// The client connects, and reconnects, by itself. After a loss nothing resumes: the output is not armed, and the
    /// game must put its objects again, best when <see cref="Connected"/> is raised.
    /// </summary>
    public sealed partial class HapticClient : IDisposable
    {
        private const double End = 0.5; // [s] that Dispose may wait

        private readonly SharedState _shared;
        private readonly Worker _worker;
        private readonly List<Thread> _stops = new List<Thread>();
        private readonly TouchTracker _touches = new TouchTracker();
        private SessionState _sessionState = SessionState.None(ClientStatus.Stopped, "");
        private RoundTrips _roundTrips;
        private double _offset;
        private bool _started, _ended, _reportedNoSession;
        private int _thread; // the thread that ticked last, or called first; 0: none
        private volatile bool _reportedThread;
        private string _stopProblem; // of an emergency stop that was not confirmed; null: none

        /// <summary>Creates a client that is not started.</summary>
        public HapticClient(Options options)
        {
            _shared = new SharedState(options);
            _worker = new Worker(_shared);
        }

        /// <summary>Ends the worker of a client that was not disposed.</summary>
        ~HapticClient()
        {
            _worker?.End();
        }

        /// <summary>
        /// A session has started: put the objects now. A session that begins and ends between two ticks is not reported.
        /// </summary>
        public event Action Connected;

        /// <summary>The session has ended. The argument is the reason. Nothing of the session continues.</summary>
        public event Action<string> Lost;

        /// <summary>
        /// The output ended unasked: another owner, an emergency stop or a fault; without `resume` also an expired
        /// lease.
        /// </summary>
        public event Action<Refusal> Ended;

        /// <summary>The server refused a command or request.</summary>
        public event Action<Refusal> Refused;

        /// <summary>The server has published a state, which is valid until the next tick.</summary>
        public event Action<State> StateChanged;

        /// <summary>
        /// A hand begins to feel an object of this client's scene. Touches arrive with the states, 60 times a second.
        /// </summary>
        public event Action<HandTouch> TouchBegan;

        /// <summary>A hand still feels an object: its position and strength.</summary>
        public event Action<HandTouch> TouchMoved;

        /// <summary>A hand no longer feels an object. The argument is the last report of the touch.</summary>
        public event Action<HandTouch> TouchEnded;

        /// <summary>
        /// The game stood still for longer than its lease while it was armed, and its session goes on. The output sounds
        /// again by itself if the client armed it with `resume` and still owns it, and if nothing else has ended the sound.
        /// </summary>
        public event Action<Standstill> StoodStill;

        /// <summary>Starts to connect. A client that was disposed stays stopped: make another.</summary>
        public void Start()
        {
            if (!_started && !_ended)
            {
                _started = true;
                _sessionState = SessionState.None(ClientStatus.Connecting, "");
                _shared.Inbox.SetSessionState(_sessionState);
                _worker.Start();
            }
        }

        /// <summary>
        /// Renews the lease and raises the events; call it once per frame. A game that does not tick is silent when its
        /// lease is over, until it ticks again. Before Start and after Dispose, it only raises <see cref="Refused"/>.
        /// </summary>
        public void Tick()
        {
            string problem = Interlocked.Exchange(ref _stopProblem, null);
            if (problem != null)
            {
                Refused?.Invoke(ErrorMessages.Unstopped(problem));
            }
            if (_ended)
            {
                return;
            }
            Volatile.Write(ref _thread, Environment.CurrentManagedThreadId);
            double still, worker;
            _shared.Heartbeat.RecordTick(Now, out still, out worker);
            _worker.Wake();
            bool stood = Armed && still > Lease;
            int session = _sessionState.Session;
            bool fresh = _shared.Inbox.TakeState(out _sessionState, out _roundTrips, out _offset);
            if (stood && _sessionState.Session == session)
            {
                StoodStill?.Invoke(new Standstill { Seconds = still, Whole = worker > 0.75 * still });
            }
            ClientEvent clientEvent;
            while (!_ended && _shared.Inbox.TakeEvent(out clientEvent, ref _sessionState))
            {
                Raise(clientEvent);
            }
            if (fresh && !_ended)
            {
                UpdateTouches(State.Scene == Scene ? State : null);
                StateChanged?.Invoke(State);
            }
        }

        /// <summary>Ends the session, and the sound if this client owns the output. Waits for half a second at most.</summary>
        public void Dispose()
        {
            if (_ended)
            {
                return;
            }
            _ended = true;
            _touches.End();
            GC.SuppressFinalize(this);
            double due = SteadyClock.Now() + End;
            _worker.End();
            _worker.Join(Left(due));
            lock (_stops)
            {
                foreach (Thread stop in _stops)
                {
                    stop.Join(Left(due));
                }
            }
            _sessionState = SessionState.None(ClientStatus.Stopped, _shared.Inbox.SessionState.Problem);
        }

        private static int Left(double due)
        {
            return (int)Math.Max(0.0, 1e3 * (due - SteadyClock.Now()));
        }

        private void UpdateTouches(State state)
        {
            _touches.ReportChanges(state, TouchBegan, TouchMoved, TouchEnded);
        }

        private void Raise(ClientEvent clientEvent)
        {
            switch (clientEvent.What)
            {
                case ClientEventKind.Connected: _reportedNoSession = false; Connected?.Invoke(); break;
                case ClientEventKind.Lost: UpdateTouches(null); Lost?.Invoke(clientEvent.Why.Message); break;
                case ClientEventKind.Ended: Ended?.Invoke(clientEvent.Why); break;
                case ClientEventKind.Refused: Refused?.Invoke(clientEvent.Why); break;
                case ClientEventKind.Answered: clientEvent.Callback(clientEvent.Answer); break;
            }
        }
    }
}
