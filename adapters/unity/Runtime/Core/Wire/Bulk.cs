using System;
using System.Runtime.InteropServices;

namespace Pacinian.Wire
{
    /// <summary>Bytes, usually little-endian numbers, in a buffer that grows and never shrinks. Copies share the buffer.</summary>
    public struct Bulk
    {
        /// <summary>The buffer, of which the first <see cref="Count"/> bytes are used; null if it was never used.</summary>
        public byte[] Data { get; private set; }

        /// <summary>The number of bytes.</summary>
        public int Count { get; private set; }

        /// <summary>The number of 32-bit numbers.</summary>
        public int Numbers
        {
            get { return Count / 4; }
        }

        /// <summary>Removes all bytes.</summary>
        public void Clear()
        {
            Count = 0;
        }

        /// <summary>Makes room for more bytes after the present ones.</summary>
        public void Reserve(int more)
        {
            if (Data == null || Count + more > Data.Length)
            {
                byte[] larger = new byte[Math.Max(Count + more, Data == null ? 0 : 2 * Data.Length)];
                if (Count > 0)
                {
                    Buffer.BlockCopy(Data, 0, larger, 0, Count);
                }
                Data = larger;
            }
        }

        /// <summary>Replaces all bytes.</summary>
        public void Set(byte[] data, int start, int count)
        {
            Count = 0;
            Reserve(count);
            Buffer.BlockCopy(data, start, Data, 0, count);
            Count = count;
        }

        /// <summary>Appends a float32.</summary>
        public void Add(double value)
        {
            Add(new Bits { Single = (float)value }.Whole);
        }

        /// <summary>Appends three float32.</summary>
        public void Add(Vec3 value)
        {
            Add(value.X);
            Add(value.Y);
            Add(value.Z);
        }

        /// <summary>Appends four float32.</summary>
        public void Add(Quat value)
        {
            Add(value.X);
            Add(value.Y);
            Add(value.Z);
            Add(value.W);
        }

        /// <summary>Appends a uint32.</summary>
        public void Add(uint value)
        {
            Reserve(4);
            for (int i = 0; i < 4; i++)
            {
                Data[Count++] = (byte)(value >> (8 * i));
            }
        }

        /// <summary>Returns the float32 at an index.</summary>
        public float Single(int index)
        {
            return new Bits { Whole = Index(index) }.Single;
        }

        /// <summary>Returns the point at an index: three float32.</summary>
        public Vec3 Point(int index)
        {
            return new Vec3(Single(3 * index), Single(3 * index + 1), Single(3 * index + 2));
        }

        /// <summary>Returns the uint32 at an index; cast it for an int32.</summary>
        public uint Index(int index)
        {
            return (uint)Little(4 * index, 4);
        }

        /// <summary>Returns the uint16 at an index.</summary>
        public int Level(int index)
        {
            return (int)Little(2 * index, 2);
        }

        /// <summary>Returns the float64 at an index.</summary>
        public double Real(int index)
        {
            return BitConverter.Int64BitsToDouble((long)Little(8 * index, 8));
        }

        private ulong Little(int at, int size)
        {
            if (at < 0 || at + size > Count)
            {
                throw new ArgumentOutOfRangeException("index");
            }
            ulong value = 0;
            for (int i = size - 1; i >= 0; i--)
            {
                value = (value << 8) | Data[at + i];
            }
            return value;
        }
    }

    /// <summary>Converts between a number and its bits, without `unsafe`.</summary>
    [StructLayout(LayoutKind.Explicit)]
    internal struct Bits
    {
        [FieldOffset(0)] public float Single;
        [FieldOffset(0)] public uint Whole;
    }
}
