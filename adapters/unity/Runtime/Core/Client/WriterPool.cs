using System.Collections.Generic;
using Pacinian.Wire;

namespace Pacinian
{
    /// <summary>Writers of parts of messages, which are used again. For any thread.</summary>
    internal sealed class WriterPool
    {
        private readonly Stack<Writer> _spare = new Stack<Writer>();

        /// <summary>An empty writer.</summary>
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

        /// <summary>It is not needed any more; null will do, too.</summary>
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
