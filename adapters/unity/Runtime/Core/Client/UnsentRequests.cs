using System.Collections.Generic;

namespace Pacinian
{
    /// <summary>The requests that wait to be sent, oldest first: the game adds them, the worker takes them.</summary>
    internal sealed class UnsentRequests
    {
        private const int MaxWaiting = 1000; // requests

        private readonly Queue<PendingRequest> _waiting = new Queue<PendingRequest>();
        private int _session;

        /// <summary>
        /// Starts a session without waiting requests. session: 0 for none. inbox: receives an event of each dropped
        /// request.
        /// </summary>
        public void Open(int session, Inbox inbox)
        {
            lock (_waiting)
            {
                while (_waiting.Count > 0)
                {
                    inbox.AddAnswer(_waiting.Dequeue(), null);
                }
                _session = session;
            }
        }

        /// <summary>Adds a request. Returns false if the session is another, or if too many requests wait.</summary>
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

        /// <summary>The next request, which stays in the queue; null if none waits.</summary>
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

        /// <summary>Removes the next request.</summary>
        public void RemoveNext()
        {
            lock (_waiting)
            {
                _waiting.Dequeue();
            }
        }
    }
}
