using System;
using System.Text;

namespace Pacinian.Wire
{
    /// <summary>Writes MessagePack into a buffer of its own, which grows and never shrinks: shortest forms, 64-bit floats.</summary>
    public sealed partial class Writer
    {
        private static readonly UTF8Encoding Utf = new UTF8Encoding(false);

        /// <summary>What was written: the first <see cref="Count"/> bytes.</summary>
        public byte[] Data { get; private set; }

        /// <summary>How many bytes were written.</summary>
        public int Count { get; private set; }

        /// <summary>capacity: bytes before it grows.</summary>
        public Writer(int capacity = 256)
        {
            Data = new byte[capacity];
        }

        /// <summary>Begins again.</summary>
        public void Clear()
        {
            Count = 0;
        }

        /// <summary>The head of a map of so many keys, which follow.</summary>
        public void Map(int count)
        {
            Head(count, 0x80, 16, 0xDE);
        }

        /// <summary>The head of an array of so many items, which follow.</summary>
        public void Array(int count)
        {
            Head(count, 0x90, 16, 0xDC);
        }

        /// <summary>Nil.</summary>
        public void Nil()
        {
            Byte(0xC0);
        }

        /// <summary>True or false.</summary>
        public void Bool(bool value)
        {
            Byte(value ? 0xC3 : 0xC2);
        }

        /// <summary>A whole number.</summary>
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

        /// <summary>A number.</summary>
        public void Real(double value)
        {
            Number(0xCB, 8, (ulong)BitConverter.DoubleToInt64Bits(value));
        }

        /// <summary>A number, or nil.</summary>
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

        /// <summary>A message, or nil for null.</summary>
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

        /// <summary>Text; null is empty.</summary>
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

        /// <summary>A word of which the bytes are known.</summary>
        internal void Word(byte[] value)
        {
            Byte(0xA0 | value.Length);
            Raw(value, 0, value.Length);
        }

        /// <summary>Bytes.</summary>
        public void Binary(Bulk value)
        {
            int size = value.Count <= byte.MaxValue ? 1 : value.Count <= ushort.MaxValue ? 2 : 4;
            Number(size == 1 ? 0xC4 : size == 2 ? 0xC5 : 0xC6, size, (ulong)value.Count);
            if (value.Count > 0)
            {
                Raw(value.Data, 0, value.Count);
            }
        }

        /// <summary>What another has written.</summary>
        public void Append(Writer other)
        {
            Raw(other.Data, 0, other.Count);
        }

        /// <summary>Bytes that are MessagePack already.</summary>
        public void Raw(byte[] data, int start, int count)
        {
            Reserve(count);
            Buffer.BlockCopy(data, start, Data, Count, count);
            Count += count;
        }
    }
}
