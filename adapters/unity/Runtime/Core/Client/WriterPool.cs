using System.Collections.Generic;
using Pacinian.Wire;

namespace Pacinian
{
    /// <summary>A pool of writers for parts of messages. Thread-safe.</summary>
    internal sealed class WriterPool
    {
        private readonly Stack<Writer> _spare = new Stack<Writer>();

        /// <summary>Returns an empty writer.</summary>
        public Writer Rent()
        {
            lock (_spare)
            {
                if (_spare.Count == 0)
                {
                    return new Writer();
                }
                Writer part = _spare.Pop();
                part.Clear();
                return part;
            }
        }

        /// <summary>Puts a writer back; null is allowed.</summary>
        public void Return(Writer part)
        {
            if (part != null)
            {
                lock (_spare)
                {
                    _spare.Push(part);
                }
            }
        }
    }
}
