using System.Text;

namespace Pacinian.Wire
{
    /// <summary>Inspects UTF-8 without creating strings.</summary>
    internal static class Utf8
    {
        private static readonly int[] Least = { 0, 0, 0x80, 0x800, 0x10000 };

        /// <summary>Returns the bytes of words.</summary>
        public static byte[][] Of(params string[] words)
        {
            byte[][] made = new byte[words.Length][];
            for (int i = 0; i < words.Length; i++)
            {
                made[i] = Encoding.UTF8.GetBytes(words[i]);
            }
            return made;
        }

        /// <summary>Returns the number of code points; -1 if the bytes are not UTF-8.</summary>
        public static int Points(byte[] data, int start, int count)
        {
            int points = 0;
            for (int at = start, end = start + count; at < end; points++)
            {
                if (Next(data, ref at, end) < 0)
                {
                    return -1;
                }
            }
            return points;
        }

        /// <summary>Returns whether bytes, which must be UTF-8, equal a text.</summary>
        public static bool Same(byte[] data, int start, int count, string text)
        {
            int i = 0;
            for (int at = start, end = start + count; at < end; i++)
            {
                int point = Next(data, ref at, end);
                if (point >= 0x10000)
                {
                    if (i + 1 >= text.Length || text[i++] != (char)(0xD7C0 + (point >> 10)))
                    {
                        return false;
                    }
                    point = 0xDC00 | (point & 0x3FF);
                }
                if (i >= text.Length || text[i] != (char)point)
                {
                    return false;
                }
            }
            return i == text.Length;
        }

        /// <summary>Returns whether bytes equal those of a word.</summary>
        public static bool Same(byte[] data, int start, int count, byte[] word)
        {
            if (word.Length != count)
            {
                return false;
            }
            for (int i = 0; i < count; i++)
            {
                if (data[start + i] != word[i])
                {
                    return false;
                }
            }
            return true;
        }

        /// <summary>Reads the next code point, and advances; -1 if it is not valid.</summary>
        private static int Next(byte[] data, ref int at, int end)
        {
            int first = data[at++];
            if (first < 0x80)
            {
                return first;
            }
            int length = first < 0xC0 ? 0 : first < 0xE0 ? 2 : first < 0xF0 ? 3 : first < 0xF8 ? 4 : 0;
            if (length == 0 || at + length - 1 > end)
            {
                return -1;
            }
            int point = first & (0x7F >> length);
            for (int i = 1; i < length; i++, at++)
            {
                if ((data[at] & 0xC0) != 0x80)
                {
                    return -1;
                }
                point = (point << 6) | (data[at] & 0x3F);
            }
            bool surrogate = point >= 0xD800 && point < 0xE000;
            return point < Least[length] || point > 0x10FFFF || surrogate ? -1 : point;
        }
    }
}
