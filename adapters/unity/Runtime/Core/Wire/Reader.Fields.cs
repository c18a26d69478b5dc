using System.Text;

namespace Pacinian.Wire
{
    /// <summary>Reads messages as maps: keys, types, and the path of an error.</summary>
    public sealed partial class Reader
    {
        /// <summary>The result of <see cref="Key"/> for an unknown key.</summary>
        internal const int Other = -1;

        /// <summary>The result for an error.</summary>
        internal const int Failed = -2;

        private const string NoValue = "is cut short, or has a byte that MessagePack never uses";
        private const int MaxPathLength = 200; // characters of a path in a message
        private static readonly byte[][] Type = Utf8.Of("type");

        /// <summary>Reads the next key. Returns its index, Other or Failed. likely: the index to compare first.</summary>
        internal int Key(byte[][] keys, int likely)
        {
            Head head;
            if (!TextNext() || !Take(out head))
            {
                return Failed;
            }
            if (likely < keys.Length && Utf8.Same(_data, head.Start, head.Count, keys[likely]))
            {
                return likely;
            }
            for (int i = 0; i < keys.Length; i++)
            {
                if (Utf8.Same(_data, head.Start, head.Count, keys[i]))
                {
                    return i;
                }
            }
            return Other;
        }

        /// <summary>Returns the index of the `type` of the message that begins here, or Failed. Consumes nothing.</summary>
        internal int Tag(byte[][] tags)
        {
            int start = _at, count, index;
            if (!Map(out count))
            {
                return Failed;
            }
            for (; count > 0; count--)
            {
                int key = Key(Type, 0);
                if (key == 0)
                {
                    bool known = Tag(tags, out index);
                    _at = start;
                    return known || Within(".type") ? index : Failed;
                }
                if (key == Failed || !Skip())
                {
                    return Failed;
                }
            }
            Fail("is missing");
            Within(".type");
            return Failed;
        }

        /// <summary>Checks that the `type` is this one.</summary>
        internal bool Expect(byte[][] tag)
        {
            int index;
            return Tag(tag, out index);
        }

        private bool Tag(byte[][] tags, out int index)
        {
            index = 0;
            return TextNext() && Word(tags, out index);
        }

        private bool TextNext()
        {
            return _at >= _end || IsText() || Fail("must be str");
        }

        /// <summary>Returns whether a text comes next.</summary>
        internal bool IsText()
        {
            int code = _at < _end ? _data[_at] : 0;
            return (code >= 0xA0 && code < 0xC0) || (code >= 0xD9 && code <= 0xDB);
        }

        /// <summary>Reports that the first of these fields is missing. Returns false.</summary>
        internal bool Missing(byte[][] keys, ulong fields)
        {
            int first = 0;
            while ((fields >> first & 1) == 0)
            {
                first++;
            }
            Fail("is missing");
            return Within(keys, first);
        }

        /// <summary>Adds the field with this index to the error's path. Returns false.</summary>
        internal bool Within(byte[][] keys, int key)
        {
            return key < 0 ? false : Within("." + Encoding.UTF8.GetString(keys[key]));
        }

        /// <summary>Adds the item with this index to the error's path. Returns false.</summary>
        internal bool Within(int index)
        {
            return Within("[" + index + "]");
        }

        /// <summary>Adds a part to the error's path. Returns false.</summary>
        internal bool Within(string part)
        {
            if (!_whole)
            {
                string path = "$" + part + Path.Substring(1);
                Path = path.Length > MaxPathLength ? path.Substring(0, MaxPathLength) : path;
            }
            return false;
        }

        /// <summary>Reports an error here. Returns false.</summary>
        internal bool Fail(string problem)
        {
            Problem = Problem.Length == 0 ? problem : Problem;
            return false;
        }

        private bool Wrong(string problem, Head head)
        {
            bool broken = head.Kind == Kind.Never || head.Cut;
            return broken ? Broken(NoValue) : Fail(problem);
        }

        private bool Unknown(Head head)
        {
            bool text = Utf8.Points(_data, head.Start, head.Count) >= 0;
            return text ? Fail("must be a word that is known here") : Broken("has text that is not UTF-8");
        }

        /// <summary>Reports bytes that are not MessagePack: the whole message is wrong. Returns false.</summary>
        private bool Broken(string problem)
        {
            _whole = true;
            return Fail(problem);
        }
    }
}
