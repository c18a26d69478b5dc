using System;

namespace Pacinian.Wire
{
    /// <summary>A list that keeps removed items for reuse. It grows and never shrinks.</summary>
    public sealed class Items<T>
    {
        private T[] _slots = new T[4];

        /// <summary>The number of items.</summary>
        public int Count { get; private set; }

        /// <summary>The item at an index below <see cref="Count"/>.</summary>
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

        /// <summary>Removes all items, but keeps them for reuse.</summary>
        public void Clear()
        {
            Count = 0;
        }

        /// <summary>
        /// Returns the former item after the end, which may be changed and added again; the type's default if there is
        /// none.
        /// </summary>
        public T Spare()
        {
            return Count < _slots.Length ? _slots[Count] : default(T);
        }

        /// <summary>Appends an item.</summary>
        public void Add(T item)
        {
            if (Count == _slots.Length)
            {
                Array.Resize(ref _slots, 2 * Count);
            }
            _slots[Count++] = item;
        }

        /// <summary>Forgets the former item after the end, because it is used elsewhere.</summary>
        internal void Forget()
        {
            if (Count < _slots.Length)
            {
                _slots[Count] = default(T);
            }
        }

        /// <summary>Replaces the item at an index below <see cref="Count"/>.</summary>
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
