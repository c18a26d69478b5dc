using System.Collections.Generic;
using Pacinian.Wire;

namespace Pacinian
{
    /// <summary>Buffers for parts of messages, which are used again. For any thread.</summary>
    internal sealed class Parts
    {
        private readonly Stack<Writer> _spare = new Stack<Writer>();

        /// <summary>An empty one.</summary>
        public Writer Take()
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
        public void GiveBack(Writer part)
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
