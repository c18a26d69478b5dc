using System;
using System.Collections.Generic;

namespace Pacinian.Zmtp
{
    /// <summary>The encoded frames that wait to be sent (RFC 37, "Framing").</summary>
    internal sealed class FrameWriter
    {
        private readonly Queue<long> _ends = new Queue<long>(); // of the frames, counted from the first byte ever written
        private byte[] _data = new byte[1024];
        private int _start, _end;
        private long _sent;

        /// <summary>The buffer with the waiting bytes.</summary>
        public byte[] Data
        {
            get { return _data; }
        }

        /// <summary>The offset of the waiting bytes in <see cref="Data"/>.</summary>
        public int Offset
        {
            get { return _start; }
        }

        /// <summary>The number of waiting bytes.</summary>
        public int Count
        {
            get { return _end - _start; }
        }

        /// <summary>The number of waiting frames, including a frame that is partly sent.</summary>
        public int Frames
        {
            get { return _ends.Count; }
        }

        /// <summary>Removes bytes that were sent.</summary>
        public void MarkSent(int count)
        {
            _start += count;
            _sent += count;
            while (_ends.Count > 0 && _ends.Peek() <= _sent)
            {
                _ends.Dequeue();
            }
        }

        /// <summary>Writes bytes that are not a frame.</summary>
        public void WriteRaw(byte[] bytes)
        {
            Reserve(bytes.Length);
            Put(bytes, 0, bytes.Length);
        }

        /// <summary>Writes a message of one part.</summary>
        public void WriteMessage(byte[] body, int count)
        {
            WriteHead(0, count);
            Put(body, 0, count);
            _ends.Enqueue(_sent + Count);
        }

        /// <summary>Writes a command: its name, then its data (RFC 37, "Formal Grammar").</summary>
        public void WriteCommand(byte[] name, byte[] data, int count)
        {
            WriteHead(Frame.Command, 1 + name.Length + count);
            _data[_end++] = (byte)name.Length;
            Put(name, 0, name.Length);
            Put(data, 0, count);
            _ends.Enqueue(_sent + Count);
        }

        private void WriteHead(int flags, int size)
        {
            Reserve(9 + size);
            if (size <= Frame.MaxShort)
            {
                _data[_end++] = (byte)flags;
                _data[_end++] = (byte)size;
                return;
            }
            _data[_end++] = (byte)(flags | Frame.Long);
            for (int shift = 56; shift >= 0; shift -= 8)
            {
                _data[_end++] = (byte)((long)size >> shift);
            }
        }

        private void Put(byte[] from, int offset, int count)
        {
            Buffer.BlockCopy(from, offset, _data, _end, count);
            _end += count;
        }

        private void Reserve(int count)
        {
            if (_data.Length - _end >= count)
            {
                return;
            }
            byte[] data = _data;
            if (Count + count > data.Length)
            {
                data = new byte[Math.Max(Count + count, 2 * data.Length)];
            }
            Buffer.BlockCopy(_data, _start, data, 0, Count);
            _end -= _start;
            _start = 0;
            _data = data;
        }
    }
}
