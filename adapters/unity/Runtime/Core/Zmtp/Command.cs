using System;
using System.Text;

namespace Pacinian.Zmtp
{
    /// <summary>
    /// Names of commands, and reading and writing of their properties (RFC 37, "Commands" and "Connection Metadata").
    /// </summary>
    internal static class Command
    {
        public static readonly byte[] Hello = Name("HELLO"), Welcome = Name("WELCOME"), Initiate = Name("INITIATE");
        public static readonly byte[] Ready = Name("READY"), Error = Name("ERROR");
        public static readonly byte[] Ping = Name("PING"), Pong = Name("PONG");
        public static readonly byte[] Subscribe = Name("SUBSCRIBE");
        private static readonly byte[] MisspeltError = Name("^RROR");

        /// <summary>The largest accepted body of a command; a READY with all its properties has about 100 bytes.</summary>
        public const int MaxBytes = 4096;

        private const int MaxShown = 100; // characters

        /// <summary>Returns whether the last frame is the command with this name; writes where its data are.</summary>
        public static bool Is(FrameReader frame, byte[] name, out int offset, out int count)
        {
            offset = frame.Offset + 1 + name.Length;
            count = frame.Count - 1 - name.Length;
            return frame.IsCommand && count >= 0 && frame.Data[frame.Offset] == name.Length && Begins(frame, 1, name);
        }

        /// <summary>
        /// Returns whether the last frame is ERROR; writes where its data are. libzmq's PLAIN server, up to 4.3.5,
        /// writes "^RROR" instead of the length 5 and "ERROR": its source has "\x05ERROR", where C takes the first E
        /// for a digit of the escape.
        /// </summary>
        public static bool IsError(FrameReader frame, out int offset, out int count)
        {
            if (Is(frame, Error, out offset, out count))
            {
                return true;
            }
            offset = frame.Offset + MisspeltError.Length;
            count = frame.Count - MisspeltError.Length;
            return frame.IsCommand && count >= 0 && Begins(frame, 0, MisspeltError);
        }

        /// <summary>Reads a text whose first byte is its length; null if it is truncated.</summary>
        public static string ReadText(byte[] data, int offset, int count)
        {
            if (count < 1 || data[offset] > count - 1)
            {
                return null;
            }
            return Encoding.ASCII.GetString(data, offset + 1, data[offset]);
        }

        /// <summary>Reads the reason of an ERROR, for people.</summary>
        public static string ReadReason(byte[] data, int offset, int count)
        {
            string text = ReadText(data, offset, count);
            return text == null ? "an error that cannot be read" : MakeVisible(text);
        }

        /// <summary>Makes a peer's text printable: truncates it, and replaces invisible characters by question marks.</summary>
        public static string MakeVisible(string text)
        {
            char[] characters = text.ToCharArray(0, Math.Min(text.Length, MaxShown));
            for (int i = 0; i < characters.Length; i++)
            {
                characters[i] = characters[i] < ' ' || characters[i] > '~' ? '?' : characters[i];
            }
            return new string(characters);
        }

        /// <summary>
        /// Finds a property by name, ignoring case. Returns "" if there is none, null if the properties are truncated.
        /// </summary>
        public static string FindProperty(byte[] data, int offset, int count, string name)
        {
            string found = "";
            int end = offset + count;
            while (offset < end)
            {
                string key = ReadText(data, offset, end - offset);
                if (string.IsNullOrEmpty(key))
                {
                    return null;
                }
                offset += 1 + key.Length;
                if (end - offset < 4)
                {
                    return null;
                }
                uint size = (uint)(data[offset] << 24 | data[offset + 1] << 16 | data[offset + 2] << 8 | data[offset + 3]);
                offset += 4;
                if (size > (uint)(end - offset))
                {
                    return null;
                }
                if (string.Equals(key, name, StringComparison.OrdinalIgnoreCase))
                {
                    found = Encoding.ASCII.GetString(data, offset, (int)size);
                }
                offset += (int)size;
            }
            return found;
        }

        /// <summary>Encodes properties: name, value, name, value and so on.</summary>
        public static byte[] WriteProperties(params string[] pairs)
        {
            int count = 0;
            for (int i = 0; i < pairs.Length; i++)
            {
                count += pairs[i].Length + (i % 2 == 0 ? 1 : 4);
            }
            byte[] made = new byte[count];
            int at = 0;
            for (int i = 0; i < pairs.Length; i++)
            {
                at += i % 2 == 0 ? 0 : 3; // a value's size has four bytes, of which these are 0
                made[at++] = (byte)pairs[i].Length;
                at += Encoding.ASCII.GetBytes(pairs[i], 0, pairs[i].Length, made, at);
            }
            return made;
        }

        private static bool Begins(FrameReader frame, int at, byte[] text)
        {
            for (int i = 0; i < text.Length; i++)
            {
                if (frame.Data[frame.Offset + at + i] != text[i])
                {
                    return false;
                }
            }
            return true;
        }

        private static byte[] Name(string name)
        {
            return Encoding.ASCII.GetBytes(name);
        }
    }
}
