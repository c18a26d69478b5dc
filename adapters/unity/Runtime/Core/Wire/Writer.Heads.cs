using System;

namespace Pacinian.Wire
{
    /// <summary>Writes the heads of values in their shortest forms.</summary>
    public sealed partial class Writer
    {
        private void Large(ulong value)
        {
            if (value < 128)
            {
                Byte((int)value);
            }
            else if (value <= byte.MaxValue)
            {
                Number(0xCC, 1, value);
            }
            else if (value <= ushort.MaxValue)
            {
                Number(0xCD, 2, value);
            }
            else
            {
                Number(value <= uint.MaxValue ? 0xCE : 0xCF, value <= uint.MaxValue ? 4 : 8, value);
            }
        }

        private void Head(int count, int small, int below, int medium)
        {
            if (count < below)
            {
                Byte(small | count);
            }
            else if (count <= ushort.MaxValue)
            {
                Number(medium, 2, (ulong)count);
            }
            else
            {
                Number(medium + 1, 4, (ulong)count);
            }
        }

        private void Number(int head, int size, ulong value)
        {
            Reserve(1 + size);
            Data[Count++] = (byte)head;
            for (int shift = 8 * (size - 1); shift >= 0; shift -= 8)
            {
                Data[Count++] = (byte)(value >> shift);
            }
        }

        private void Byte(int value)
        {
            Reserve(1);
            Data[Count++] = (byte)value;
        }

        private void Reserve(int more)
        {
            if (Count + more > Data.Length)
            {
                byte[] larger = new byte[Math.Max(Count + more, 2 * Data.Length)];
                Buffer.BlockCopy(Data, 0, larger, 0, Count);
                Data = larger;
            }
        }
    }
}
