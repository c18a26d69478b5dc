using System;
using System.Text;

namespace Pacinian.Wire
{
    /// <summary>Writes MessagePack, in the shortest forms and with 64-bit floats, into a buffer that grows and never shrinks.</summary>
    public sealed partial class Writer
    {
        private static readonly UTF8Encoding Utf = new UTF8Encoding(false);

        /// <summary>The buffer, of which the first <see cref="Count"/> bytes were written.</summary>
        public byte[] Data { get; private set; }

        /// <summary>The number of bytes written.</summary>
        public int Count { get; private set; }

        /// <summary>capacity: bytes before the buffer grows.</summary>
        public Writer(int capacity = 256)
        {
            Data = new byte[capacity];
        }

        /// <summary>Removes all bytes.</summary>
        public void Clear()
        {
            Count = 0;
        }

        /// <summary>Writes the head of a map with `count` keys, which must follow.</summary>
        public void Map(int count)
        {
            Head(count, 0x80, 16, 0xDE);
        }

        /// <summary>Writes the head of an array with `count` items, which must follow.</summary>
        public void Array(int count)
        {
            Head(count, 0x90, 16, 0xDC);
        }

        /// <summary>Writes nil.</summary>
        public void Nil()
        {
            Byte(0xC0);
        }

        /// <summary>Writes a boolean.</summary>
        public void Bool(bool value)
        {
            Byte(value ? 0xC3 : 0xC2);
        }

        /// <summary>Writes an integer.</summary>
        public void Whole(long value)
        {
            if (value >= 0)
            {
                Large((ulong)value);
            }
            else if (value >= -32)
            {
                Byte((int)value & 0xFF);
            }
            else if (value >= sbyte.MinValue)
            {
                Number(0xD0, 1, (ulong)value);
            }
            else if (value >= short.MinValue)
            {
                Number(0xD1, 2, (ulong)value);
            }
            else if (value >= int.MinValue)
            {
                Number(0xD2, 4, (ulong)value);
            }
            else
            {
                Number(0xD3, 8, (ulong)value);
            }
        }

        /// <summary>Writes a floating-point number.</summary>
        public void Real(double value)
        {
            Number(0xCB, 8, (ulong)BitConverter.DoubleToInt64Bits(value));
        }

        /// <summary>Writes a floating-point number, or nil.</summary>
        public void Real(double? value)
        {
            if (value.HasValue)
            {
                Real(value.Value);
            }
            else
            {
                Nil();
            }
        }

        /// <summary>Writes a message; nil for null.</summary>
        public void Message(IMessage value)
        {
            if (value == null)
            {
                Nil();
            }
            else
            {
                value.Write(this);
            }
        }

        /// <summary>Writes a text; null is written as an empty text.</summary>
        public void Text(string value)
        {
            int length = value == null ? 0 : Utf.GetByteCount(value);
            if (length >= 32 && length <= byte.MaxValue)
            {
                Number(0xD9, 1, (ulong)length);
            }
            else
            {
                Head(length, 0xA0, 32, 0xDA);
            }
            Reserve(length);
            Count += length == 0 ? 0 : Utf.GetBytes(value, 0, value.Length, Data, Count);
        }

        /// <summary>Writes a word from its bytes.</summary>
        internal void Word(byte[] value)
        {
            Byte(0xA0 | value.Length);
            Raw(value, 0, value.Length);
        }

        /// <summary>Writes bytes.</summary>
        public void Binary(Bulk value)
        {
            int size = value.Count <= byte.MaxValue ? 1 : value.Count <= ushort.MaxValue ? 2 : 4;
            Number(size == 1 ? 0xC4 : size == 2 ? 0xC5 : 0xC6, size, (ulong)value.Count);
            if (value.Count > 0)
            {
                Raw(value.Data, 0, value.Count);
            }
        }

        /// <summary>Appends the bytes of another writer.</summary>
        public void Append(Writer other)
        {
            Raw(other.Data, 0, other.Count);
        }

        /// <summary>Appends bytes that are MessagePack.</summary>
        public void Raw(byte[] data, int start, int count)
        {
            Reserve(count);
            Buffer.BlockCopy(data, start, Data, Count, count);
            Count += count;
        }
    }
}
