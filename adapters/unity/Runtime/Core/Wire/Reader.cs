using System.Text;

namespace Pacinian.Wire
{
    /// <summary>
    /// Reads MessagePack. Whatever the bytes are, it neither throws nor allocates more than they hold: what is wrong
    /// is false, and then <see cref="Problem"/> and <see cref="Path"/> say what and where.
    /// </summary>
    public sealed partial class Reader
    {
        private byte[] _data;
        private int _at, _end;
        private bool _whole;

        /// <summary>What is wrong; empty while nothing is.</summary>
        public string Problem { get; private set; }

        /// <summary>Where that is, as "$.hands[0].joints".</summary>
        public string Path { get; private set; }

        /// <summary>Begins to read a message.</summary>
        public void Start(byte[] data, int start, int count)
        {
            _data = data;
            _at = start;
            _end = start + count;
            _whole = false;
            Problem = "";
            Path = "$";
        }

        /// <summary>Begins to read a message, which must have at most so many bytes.</summary>
        internal bool Begin(byte[] data, int start, int count, int most)
        {
            Start(data, start, count);
            return count <= most || Broken("must be of at most " + most + " bytes");
        }

        /// <summary>Whether all has been read.</summary>
        public bool End()
        {
            return _at == _end || Broken("has trailing bytes");
        }

        /// <summary>Nil is taken, anything else is left.</summary>
        public bool Nil()
        {
            bool nil = _at < _end && _data[_at] == 0xC0;
            _at += nil ? 1 : 0;
            return nil;
        }

        /// <summary>True or false.</summary>
        public bool Bool(ref bool value)
        {
            Head head;
            if (!Take(out head) || (head.Kind != Kind.Bool && !Wrong("must be bool", head)))
            {
                return false;
            }
            value = head.Whole != 0;
            return true;
        }

        /// <summary>A whole number of 64 bits.</summary>
        public bool Whole(ref long value, long low = long.MinValue, long high = long.MaxValue)
        {
            Head head;
            if (!Take(out head) || (head.Kind != Kind.Whole && !Wrong("must be int", head)))
            {
                return false;
            }
            if (head.Whole < low || head.Whole > high)
            {
                return Fail("must be from " + low + " to " + high);
            }
            value = head.Whole;
            return true;
        }

        /// <summary>Any number, NaN too.</summary>
        public bool Real(ref double value)
        {
            Head head;
            bool number = Take(out head) && (head.Kind & (Kind.Real | Kind.Whole | Kind.Huge)) != 0;
            if (!number)
            {
                return Wrong("must be float", head);
            }
            value = head.Number;
            return true;
        }

        /// <summary>A number in low..high, which is not NaN. above: low itself is too low.</summary>
        public bool Real(ref double value, double low, double high, bool above = false)
        {
            double read = 0.0;
            if (!Real(ref read))
            {
                return false;
            }
            if (!(above ? read > low : read >= low) || !(read <= high))
            {
                return Fail(Between(low, high, above));
            }
            value = read;
            return true;
        }

        /// <summary>Text of least..most code points. A text that is there already is kept: nothing is allocated.</summary>
        public bool Text(ref string value, int least = 0, int most = int.MaxValue)
        {
            Head head;
            if (!Take(out head) || (head.Kind != Kind.Text && !Wrong("must be str", head)))
            {
                return false;
            }
            int points = Utf8.Points(_data, head.Start, head.Count);
            if (points < 0)
            {
                return Broken("has text that is not UTF-8");
            }
            if (points < least || points > most)
            {
                return Fail("must be of " + least + " to " + most + " characters");
            }
            if (value == null || !Utf8.Same(_data, head.Start, head.Count, value))
            {
                value = Encoding.UTF8.GetString(_data, head.Start, head.Count);
            }
            return true;
        }

        /// <summary>The index of one of these words.</summary>
        internal bool Word(byte[][] words, out int index)
        {
            Head head;
            index = 0;
            if (!Take(out head) || (head.Kind != Kind.Text && !Wrong("must be str", head)))
            {
                return false;
            }
            for (; index < words.Length; index++)
            {
                if (Utf8.Same(_data, head.Start, head.Count, words[index]))
                {
                    return true;
                }
            }
            return Unknown(head);
        }

        /// <summary>least..most bytes.</summary>
        public bool Binary(ref Bulk value, int least = 0, int most = int.MaxValue)
        {
            Head head;
            if (!Take(out head) || (head.Kind != Kind.Binary && !Wrong("must be bin", head)))
            {
                return false;
            }
            if (head.Count < least || head.Count > most)
            {
                return Fail("must be of " + least + " to " + most + " bytes");
            }
            if (head.Cut)
            {
                return Broken("is cut short");
            }
            value.Set(_data, head.Start, head.Count);
            return true;
        }

        /// <summary>The head of an array of least..most items, which follow.</summary>
        public bool Array(out int count, int least = 0, int most = int.MaxValue)
        {
            Head head;
            count = 0;
            if (!Take(out head) || (head.Kind != Kind.Array && !Wrong("must be an array", head)))
            {
                return false;
            }
            count = head.Count;
            return (count >= least && count <= most) || Fail("must be of " + least + " to " + most + " items");
        }

        /// <summary>The head of a map of at most so many keys, which follow.</summary>
        public bool Map(out int count, int most = int.MaxValue)
        {
            Head head;
            count = 0;
            if (!Take(out head) || (head.Kind != Kind.Map && !Wrong("must be a map", head)))
            {
                return false;
            }
            count = head.Count;
            return count <= most || Fail("must be of 0 to " + most + " keys");
        }
    }
}
