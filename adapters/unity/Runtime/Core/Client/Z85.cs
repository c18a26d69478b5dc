namespace Pacinian
{
    /// <summary>Decodes keys in Z85: five characters for four bytes (ZeroMQ RFC 32).</summary>
    internal static class Z85
    {
        private const string Digits =
            "0123456789abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ.-:+=^!/*?&<>()[]{}@%$#";

        private const int Length = 40; // characters of a key

        /// <summary>Decodes the 32 bytes of a key. Returns false if the text is not a key.</summary>
        public static bool Read(string text, out byte[] key)
        {
            key = new byte[Length / 5 * 4];
            if (text.Length != Length)
            {
                return false;
            }
            ulong value = 0;
            for (int i = 0; i < Length; i++)
            {
                int digit = Digits.IndexOf(text[i]);
                if (digit < 0)
                {
                    return false;
                }
                value = 85 * value + (ulong)digit;
                if (i % 5 != 4)
                {
                    continue;
                }
                for (int j = 0; j < 4; j++)
                {
                    key[i / 5 * 4 + j] = (byte)(value >> (24 - 8 * j));
                }
                if (value > uint.MaxValue)
                {
                    return false;
                }
                value = 0;
            }
            return true;
        }
    }
}
