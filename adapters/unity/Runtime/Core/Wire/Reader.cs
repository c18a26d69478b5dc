using System.Text;

namespace Pacinian.Wire
{
    /// <summary>
    /// Reads MessagePack. For any bytes it neither throws nor allocates more than they hold. On an error, methods
    /// return false, and <see cref="Problem"/> and <see cref="Path"/> say what is wrong and where.
    /// </summary>
    public sealed partial class Reader
    {
        private const int MostRecent = 8; // texts that are kept
        private const int LongestRecent = 64; // [bytes]

        private readonly string[] _recent = new string[MostRecent];
        private byte[] _data;
        private int _at, _end, _oldest;
        private bool _whole;

        /// <summary>What is wrong; empty if nothing is.</summary>
        public string Problem { get; private set; }

        /// <summary>Where it is wrong, such as "$.hands[0].joints".</summary>
        public string Path { get; private set; }

        /// <summary>Starts to read a message.</summary>
        public void Start(byte[] data, int start, int count)
        {
            _data = data;
            _at = start;
            _end = start + count;
            _whole = false;
            Problem = "";
            Path = "$";
        }

        /// <summary>Starts to read a message of at most `most` bytes.</summary>
        internal bool Begin(byte[] data, int start, int count, int most)
        {
            Start(data, start, count);
            return count <= most || Broken("must be of at most " + most + " bytes");
        }

        /// <summary>Checks that all bytes have been read.</summary>
        public bool End()
        {
            return _at == _end || Broken("has trailing bytes");
        }

        /// <summary>Consumes a nil. Returns false, and consumes nothing, if something else comes next.</summary>
        public bool Nil()
        {
            bool nil = _at < _end && _data[_at] == 0xC0;
            _at += nil ? 1 : 0;
            return nil;
        }

        /// <summary>Reads a boolean.</summary>
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

        /// <summary>Reads an integer of 64 bits.</summary>
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

        /// <summary>Reads a number, which may be NaN.</summary>
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

        /// <summary>Reads a number in low..high, not NaN. above: excludes low itself.</summary>
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

        /// <summary>
        /// Reads a text of least..most code points. If `value` or one of the last short texts is equal, nothing is
        /// allocated: a status that goes to and fro between two words makes no garbage.
        /// </summary>
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
                value = head.Count <= LongestRecent ? FindRecent(head) : Encoding.UTF8.GetString(_data, head.Start, head.Count);
            }
            return true;
        }

        /// <summary>Returns a text that was read recently, or a new one in place of the oldest.</summary>
        private string FindRecent(Head head)
        {
            foreach (string text in _recent)
            {
                if (text != null && Utf8.Same(_data, head.Start, head.Count, text))
                {
                    return text;
                }
            }
            string made = Encoding.UTF8.GetString(_data, head.Start, head.Count);
            _recent[_oldest] = made;
            _oldest = (_oldest + 1) % MostRecent;
            return made;
        }

        /// <summary>Reads one of these words, and gives its index.</summary>
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

        /// <summary>Reads least..most bytes.</summary>
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

        /// <summary>Reads the head of an array of least..most items.</summary>
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

        /// <summary>Reads the head of a map of at most `most` keys.</summary>
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
