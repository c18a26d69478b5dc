using System.Collections.Generic;

namespace Pacinian
{
    /// <summary>Requests that wait to be sent, oldest first: the game adds, the worker takes.</summary>
    internal sealed class RequestQueue
    {
        private const int MaxWaiting = 1000; // requests

        private readonly Queue<PendingRequest> _waiting = new Queue<PendingRequest>();
        private int _session;

        /// <summary>Begins a session, with nothing that waits; 0: there is none. inbox: is told what waited in vain.</summary>
        public void Open(int session, Inbox inbox)
        {
            lock (_waiting)
            {
                while (_waiting.Count > 0)
                {
                    inbox.Answer(_waiting.Dequeue(), null);
                }
                _session = session;
            }
        }

        /// <summary>False if that is not the session that there is, or too many wait.</summary>
        public bool Add(int session, PendingRequest request)
        {
            lock (_waiting)
            {
                if (session == 0 || session != _session || _waiting.Count == MaxWaiting)
                {
                    return false;
                }
                _waiting.Enqueue(request);
                return true;
            }
        }

        /// <summary>The next one, which stays; null if none waits.</summary>
        public PendingRequest Next
        {
            get
            {
                lock (_waiting)
                {
                    return _waiting.Count > 0 ? _waiting.Peek() : null;
                }
            }
        }

        /// <summary>The next one is sent now.</summary>
        public void RemoveNext()
        {
            lock (_waiting)
            {
                _waiting.Dequeue();
            }
        }
    }
}
