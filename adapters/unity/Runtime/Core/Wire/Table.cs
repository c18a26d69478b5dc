namespace Pacinian.Wire
{
    /// <summary>Items by name, in their order. It keeps what was in it, to be used again.</summary>
    public sealed class Table<T>
    {
        private readonly Items<string> _keys = new Items<string>();
        private readonly Items<T> _values = new Items<T>();

        /// <summary>How many there are.</summary>
        public int Count
        {
            get { return _keys.Count; }
        }

        /// <summary>The name of that index.</summary>
        public string Key(int index)
        {
            return _keys[index];
        }

        /// <summary>The item of that index.</summary>
        public T Value(int index)
        {
            return _values[index];
        }

        /// <summary>The index of a name; -1 if there is none.</summary>
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

        /// <summary>Empties it.</summary>
        public void Clear()
        {
            _keys.Clear();
            _values.Clear();
        }

        /// <summary>An item in place of the one of that name, or one more.</summary>
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

        /// <summary>The name that was at the end's place before; null if none was.</summary>
        internal string SpareKey()
        {
            return _keys.Spare();
        }

        /// <summary>The item that was at the end's place before; the type's default if none was.</summary>
        internal T Spare()
        {
            return _values.Spare();
        }
    }
}
