using System;

namespace Pacinian.Wire
{
    /// <summary>A list that keeps what was in it, to be used again: it grows and never shrinks.</summary>
    public sealed class Items<T>
    {
        private T[] _slots = new T[4];

        /// <summary>How many items there are.</summary>
        public int Count { get; private set; }

        /// <summary>The item of that index, below <see cref="Count"/>.</summary>
        public T this[int index]
        {
            get
            {
                if (index < 0 || index >= Count)
                {
                    throw new ArgumentOutOfRangeException("index");
                }
                return _slots[index];
            }
        }

        /// <summary>Empties it.</summary>
        public void Clear()
        {
            Count = 0;
        }

        /// <summary>What was at the end's place before, to be changed and added; the type's default if nothing was.</summary>
        public T Spare()
        {
            return Count < _slots.Length ? _slots[Count] : default(T);
        }

        /// <summary>One more item.</summary>
        public void Add(T item)
        {
            if (Count == _slots.Length)
            {
                Array.Resize(ref _slots, 2 * Count);
            }
            _slots[Count++] = item;
        }

        /// <summary>What was at the end's place before is not used again: it is somewhere else now.</summary>
        internal void Forget()
        {
            if (Count < _slots.Length)
            {
                _slots[Count] = default(T);
            }
        }

        /// <summary>Another item at that index, below <see cref="Count"/>.</summary>
        public void Replace(int index, T item)
        {
            if (index < 0 || index >= Count)
            {
                throw new ArgumentOutOfRangeException("index");
            }
            _slots[index] = item;
        }
    }
}
