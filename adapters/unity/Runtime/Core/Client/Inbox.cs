using System;
using System.Collections.Generic;
using Pacinian.Wire;

namespace Pacinian
{
    /// <summary>
    /// What the worker passes to the game: the client's state, events and the newest state of the server. Both sides
    /// hold the lock only for a few assignments. Three state objects rotate, so that none is allocated.
    /// </summary>
    internal sealed class Inbox
    {
        private const int MaxEvents = 1000; // the oldest are dropped beyond that

        private readonly object _lock = new object();
        private readonly List<ClientEvent> _events = new List<ClientEvent>(16);
        private SessionState _sessionState = SessionState.None(ClientStatus.Stopped, "");
        private State _read = new State(), _ready = new State();
        private RoundTrips _roundTrips;
        private double _offset;
        private bool _fresh, _any, _stale;

        public Inbox()
        {
            Back = new State();
        }

        /// <summary>The state object that the worker may write.</summary>
        public State Back { get; private set; }

        /// <summary>Publishes the state that the worker has written.</summary>
        public void PublishState()
        {
            lock (_lock)
            {
                State state = _ready;
                _ready = Back;
                Back = state;
                _fresh = true;
            }
        }

        /// <summary>Sets the client's state. Published states of another session become invalid.</summary>
        public void SetSessionState(SessionState sessionState)
        {
            lock (_lock)
            {
                bool other = sessionState.Session != _sessionState.Session;
                _stale |= other;
                _fresh &= !other;
                _sessionState = sessionState;
            }
        }

        public void SetServerClock(RoundTrips roundTrips, double offset)
        {
            lock (_lock)
            {
                _roundTrips = roundTrips;
                _offset = offset;
            }
        }

        public void AddEvent(ClientEvent clientEvent)
        {
            lock (_lock)
            {
                while (_events.Count >= MaxEvents)
                {
                    _events.RemoveAt(0);
                }
                _events.Add(clientEvent);
            }
        }

        /// <summary>
        /// Adds an event that the session was lost. A session that begins and ends between two ticks is not reported.
        /// </summary>
        public void AddLoss(string problem)
        {
            lock (_lock)
            {
                int begun = _events.FindIndex(queued => queued.What == ClientEventKind.Connected);
                if (begun >= 0)
                {
                    _events.RemoveAt(begun);
                    return;
                }
            }
            AddEvent(new ClientEvent { What = ClientEventKind.Lost, Why = new Refusal { Message = problem } });
        }

        /// <summary>Adds an event that the server refused something.</summary>
        public void AddRefusal(Refusal why)
        {
            AddEvent(new ClientEvent { What = ClientEventKind.Refused, Why = why });
        }

        /// <summary>Adds an event with the answer to a request; null: there will be none.</summary>
        public void AddAnswer(PendingRequest request, Pressures answer)
        {
            if (request.Callback != null)
            {
                AddEvent(new ClientEvent { What = ClientEventKind.Answered, Callback = request.Callback, Answer = answer });
            }
        }

        /// <summary>The client's state.</summary>
        public SessionState SessionState
        {
            get
            {
                lock (_lock)
                {
                    return _sessionState;
                }
            }
        }

        /// <summary>Takes the next event, and the client's present state. Returns false if there is no event.</summary>
        public bool TakeEvent(out ClientEvent clientEvent, ref SessionState sessionState)
        {
            lock (_lock)
            {
                if (_events.Count == 0)
                {
                    clientEvent = new ClientEvent();
                    return false;
                }
                clientEvent = _events[0];
                _events.RemoveAt(0);
                sessionState = _sessionState;
                return true;
            }
        }

        /// <summary>Makes the newest state the one that the game reads. Returns false if no new one has arrived.</summary>
        public bool TakeState(out SessionState sessionState, out RoundTrips roundTrips, out double offset)
        {
            lock (_lock)
            {
                sessionState = _sessionState;
                roundTrips = _roundTrips;
                offset = _offset;
                _any &= !_stale;
                _stale = false;
                if (!_fresh)
                {
                    return false;
                }
                State state = _read;
                _read = _ready;
                _ready = state;
                _fresh = false;
                _any = true;
                return true;
            }
        }

        /// <summary>The state that the game reads; null before the first one of this session.</summary>
        public State Read
        {
            get { return _any ? _read : null; }
        }
    }
}
