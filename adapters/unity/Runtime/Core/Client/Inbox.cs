using System;
using System.Collections.Generic;
using Pacinian.Wire;

namespace Pacinian
{
    /// <summary>
    /// What the worker passes to the game: the client's state, notices and the newest state of the server. Both sides
    /// hold the lock only for a few assignments. Three state objects rotate, so that none is allocated.
    /// </summary>
    internal sealed class Inbox
    {
        private const int MaxNotices = 1000; // the oldest are dropped beyond that

        private readonly object _lock = new object();
        private readonly Queue<Notice> _notices = new Queue<Notice>(16);
        private Standing _standing = Standing.None(ClientStatus.Stopped, "");
        private State _read = new State(), _ready = new State();
        private Trips _trips;
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
        public void SetStanding(Standing standing)
        {
            lock (_lock)
            {
                bool other = standing.Session != _standing.Session;
                _stale |= other;
                _fresh &= !other;
                _standing = standing;
            }
        }

        public void SetServerClock(Trips trips, double offset)
        {
            lock (_lock)
            {
                _trips = trips;
                _offset = offset;
            }
        }

        public void AddNotice(Notice notice)
        {
            lock (_lock)
            {
                while (_notices.Count >= MaxNotices)
                {
                    _notices.Dequeue();
                }
                _notices.Enqueue(notice);
            }
        }

        /// <summary>Adds a notice that the server refused something.</summary>
        public void AddRefusal(Refusal why)
        {
            AddNotice(new Notice { What = Happening.Refused, Why = why });
        }

        /// <summary>Adds a notice with the answer to a request; null: there will be none.</summary>
        public void AddAnswer(PendingRequest request, Pressures answer)
        {
            if (request.Callback != null)
            {
                AddNotice(new Notice { What = Happening.Answered, Callback = request.Callback, Answer = answer });
            }
        }

        /// <summary>The client's state.</summary>
        public Standing Standing
        {
            get
            {
                lock (_lock)
                {
                    return _standing;
                }
            }
        }

        /// <summary>Takes the next notice, and the client's present state. Returns false if there is no notice.</summary>
        public bool TakeNotice(out Notice notice, ref Standing standing)
        {
            lock (_lock)
            {
                if (_notices.Count == 0)
                {
                    notice = new Notice();
                    return false;
                }
                notice = _notices.Dequeue();
                standing = _standing;
                return true;
            }
        }

        /// <summary>Makes the newest state the one that the game reads. Returns false if no new one has arrived.</summary>
        public bool TakeState(out Standing standing, out Trips trips, out double offset)
        {
            lock (_lock)
            {
                standing = _standing;
                trips = _trips;
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
