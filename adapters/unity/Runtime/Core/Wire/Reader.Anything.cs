namespace Pacinian.Wire
{
    /// <summary>Reads values whose type is not known in advance.</summary>
    public sealed partial class Reader
    {
        /// <summary>Skips a value of any kind and depth, without recursion.</summary>
        internal bool Skip()
        {
            for (long left = 1; left > 0; left--)
            {
                Head head;
                if (!Take(out head) || head.Cut || head.Kind == Kind.Never)
                {
                    return Broken(NoValue);
                }
                left += head.Kind == Kind.Array ? head.Count : head.Kind == Kind.Map ? 2L * head.Count : 0L;
                if (left - 1 > _end - _at)
                {
                    return Broken("is cut short");
                }
            }
            return true;
        }

        /// <summary>Reads a value of any kind.</summary>
        internal bool Any(ref Value value)
        {
            int start = _at;
            Head head;
            if (!Take(out head))
            {
                return false;
            }
            switch (head.Kind)
            {
                case Kind.Nil: value = new Value(); return true;
                case Kind.Bool: value = Value.Of(head.Whole != 0); return true;
                case Kind.Whole: value = Value.Of(head.Whole); return true;
                case Kind.Real: value = Value.Of(head.Number); return true;
            }
            _at = start;
            if (head.Kind == Kind.Text)
            {
                string text = value.Text;
                bool read = Text(ref text);
                value = read && !ReferenceEquals(text, value.Text) ? Value.Of(text) : value;
                return read;
            }
            if (!Skip())
            {
                return false;
            }
            value = Value.Of(_data, start, _at - start);
            return true;
        }
    }
}
