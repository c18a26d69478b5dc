using System.Collections.Generic;

namespace Pacinian
{
    /// <summary>Requests that wait to be sent, oldest first: the game adds, the worker takes.</summary>
    internal sealed class Requests
    {
        private const int Most = 1000; // that wait

        private readonly Queue<Asked> _waiting = new Queue<Asked>();
        private int _session;

        /// <summary>Begins a session, with nothing that waits; 0: there is none. news: is told what waited in vain.</summary>
        public void Open(int session, News news)
        {
            lock (_waiting)
            {
                while (_waiting.Count > 0)
                {
                    news.Answer(_waiting.Dequeue(), null);
                }
                _session = session;
            }
        }

        /// <summary>False if that is not the session that there is, or too many wait.</summary>
        public bool Add(int session, Asked asked)
        {
            lock (_waiting)
            {
                if (session == 0 || session != _session || _waiting.Count == Most)
                {
                    return false;
                }
                _waiting.Enqueue(asked);
                return true;
            }
        }

        /// <summary>The next one, which stays; null if none waits.</summary>
        public Asked Next
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
        public void Done()
        {
            lock (_waiting)
            {
                _waiting.Dequeue();
            }
        }
    }
}
