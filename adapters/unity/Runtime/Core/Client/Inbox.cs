using System;
using System.Collections.Generic;
using Pacinian.Wire;

namespace Pacinian
{
    /// <summary>
    /// What the worker has for the game: how it stands, what has happened, the newest state. Both sides only hold
    /// the lock for a few assignments. States go round in three objects, so that none is made while it runs.
    /// </summary>
    internal sealed class Inbox
    {
        private const int MaxNotices = 1000; // that wait; of more, the oldest are forgotten

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

        /// <summary>The state that the worker may write.</summary>
        public State Back { get; private set; }

        /// <summary>The worker has written a state.</summary>
        public void Publish()
        {
            lock (_lock)
            {
                State state = _ready;
                _ready = Back;
                Back = state;
                _fresh = true;
            }
        }

        /// <summary>How it stands now. States of another session are not read any more.</summary>
        public void Stand(Standing standing)
        {
            lock (_lock)
            {
                bool other = standing.Session != _standing.Session;
                _stale |= other;
                _fresh &= !other;
                _standing = standing;
            }
        }

        public void Time(Trips trips, double offset)
        {
            lock (_lock)
            {
                _trips = trips;
                _offset = offset;
            }
        }

        public void Tell(Notice notice)
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

        /// <summary>The server would not do something.</summary>
        public void Refuse(Refusal why)
        {
            Tell(new Notice { What = Happening.Refused, Why = why });
        }

        /// <summary>Something was answered; null: it will not be.</summary>
        public void Answer(PendingRequest request, Pressures answer)
        {
            if (request.Callback != null)
            {
                Tell(new Notice { What = Happening.Answered, Callback = request.Callback, Answer = answer });
            }
        }

        /// <summary>How it stands.</summary>
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

        /// <summary>The game takes the next notice, if there is one, and how it stands now.</summary>
        public bool Take(out Notice notice, ref Standing standing)
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

        /// <summary>The game looks: the newest state, if one has come since, is the one that is read now.</summary>
        public bool Look(out Standing standing, out Trips trips, out double offset)
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

        /// <summary>The state that the game reads, until it looks again; null before the first of this session.</summary>
        public State Read
        {
            get { return _any ? _read : null; }
        }
    }
}
