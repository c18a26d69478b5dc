namespace Pacinian.Zmtp
{
    /// <summary>Bits of a frame's first byte (RFC 37, "Framing").</summary>
    internal static class Frame
    {
        public const int More = 1, Long = 2, Command = 4, Reserved = 0xf8;

        /// <summary>The largest body whose size is one byte.</summary>
        public const int MaxShort = 255;
    }
}
