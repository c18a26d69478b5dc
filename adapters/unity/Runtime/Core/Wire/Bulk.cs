using System;
using System.Runtime.InteropServices;

namespace Pacinian.Wire
{
    /// <summary>Bytes, as a rule little-endian numbers, in a buffer that grows and never shrinks. Copies share the buffer.</summary>
    public struct Bulk
    {
        /// <summary>The first <see cref="Count"/> bytes are meant; null before the first.</summary>
        public byte[] Data { get; private set; }

        /// <summary>How many bytes there are.</summary>
        public int Count { get; private set; }

        /// <summary>How many 32-bit numbers that is.</summary>
        public int Numbers
        {
            get { return Count / 4; }
        }

        /// <summary>Empties it.</summary>
        public void Clear()
        {
            Count = 0;
        }

        /// <summary>Makes room for so many bytes after what is there.</summary>
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

        /// <summary>These bytes in place of what is there.</summary>
        public void Set(byte[] data, int start, int count)
        {
            Count = 0;
            Reserve(count);
            Buffer.BlockCopy(data, start, Data, 0, count);
            Count = count;
        }

        /// <summary>One more float32.</summary>
        public void Add(double value)
        {
            Add(new Bits { Single = (float)value }.Whole);
        }

        /// <summary>Three more float32.</summary>
        public void Add(Vec3 value)
        {
            Add(value.X);
            Add(value.Y);
            Add(value.Z);
        }

        /// <summary>Four more float32.</summary>
        public void Add(Quat value)
        {
            Add(value.X);
            Add(value.Y);
            Add(value.Z);
            Add(value.W);
        }

        /// <summary>One more uint32.</summary>
        public void Add(uint value)
        {
            Reserve(4);
            for (int i = 0; i < 4; i++)
            {
                Data[Count++] = (byte)(value >> (8 * i));
            }
        }

        /// <summary>The float32 of that index.</summary>
        public float Single(int index)
        {
            return new Bits { Whole = Index(index) }.Single;
        }

        /// <summary>The point of that index, each of three float32.</summary>
        public Vec3 Point(int index)
        {
            return new Vec3(Single(3 * index), Single(3 * index + 1), Single(3 * index + 2));
        }

        /// <summary>The uint32 of that index; an int32 by a cast.</summary>
        public uint Index(int index)
        {
            return (uint)Little(4 * index, 4);
        }

        /// <summary>The uint16 of that index.</summary>
        public int Level(int index)
        {
            return (int)Little(2 * index, 2);
        }

        /// <summary>The float64 of that index.</summary>
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

    /// <summary>A number and its bits, without `unsafe`.</summary>
    [StructLayout(LayoutKind.Explicit)]
    internal struct Bits
    {
        [FieldOffset(0)] public float Single;
        [FieldOffset(0)] public uint Whole;
    }
}
