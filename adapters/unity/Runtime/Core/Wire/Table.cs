namespace Pacinian.Wire
{
    /// <summary>Items by name, in order. Removed items are kept for reuse.</summary>
    public sealed class Table<T>
    {
        private readonly Items<string> _keys = new Items<string>();
        private readonly Items<T> _values = new Items<T>();

        /// <summary>The number of items.</summary>
        public int Count
        {
            get { return _keys.Count; }
        }

        /// <summary>Returns the name at an index.</summary>
        public string Key(int index)
        {
            return _keys[index];
        }

        /// <summary>Returns the item at an index.</summary>
        public T Value(int index)
        {
            return _values[index];
        }

        /// <summary>Returns the index of a name; -1 if there is none.</summary>
        public int Find(string key)
        {
            for (int i = 0; i < Count; i++)
            {
                if (string.Equals(_keys[i], key))
                {
                    return i;
                }
            }
            return -1;
        }

        /// <summary>Removes all items.</summary>
        public void Clear()
        {
            _keys.Clear();
            _values.Clear();
        }

        /// <summary>Replaces the item with this name, or appends it.</summary>
        public void Set(string key, T value)
        {
            int at = Find(key);
            if (at >= 0)
            {
                _values.Replace(at, value);
                _values.Forget();
                return;
            }
            _keys.Add(key);
            _values.Add(value);
        }

        /// <summary>Returns the former name after the end; null if there is none.</summary>
        internal string SpareKey()
        {
            return _keys.Spare();
        }

        /// <summary>Returns the former item after the end; the type's default if there is none.</summary>
        internal T Spare()
        {
            return _values.Spare();
        }
    }
}
