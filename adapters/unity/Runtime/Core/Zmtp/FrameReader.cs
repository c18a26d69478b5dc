using System;

namespace Pacinian.Zmtp
{
    /// <summary>
    /// Splits the bytes of a peer into frames (RFC 37, "Framing"). Checks a frame's size as soon as its head has
    /// arrived. Memory grows with the received bytes, not with the announced size.
    /// </summary>
    internal sealed class FrameReader
    {
        private const int FirstBytes = 8192;

        private readonly int _maxMessage, _maxCommand;
        private byte[] _data = new byte[FirstBytes];
        private int _start, _end, _needed;

        /// <summary>maxMessage, maxCommand: the largest accepted bodies of a part of a message and of a command [bytes].</summary>
        public FrameReader(int maxMessage, int maxCommand)
        {
            _maxMessage = maxMessage;
            _maxCommand = maxCommand;
            Problem = "";
        }

        /// <summary>The buffer with the frame's body, valid until bytes are added.</summary>
        public byte[] Data
        {
            get { return _data; }
        }

        /// <summary>The offset of the frame's body in <see cref="Data"/>.</summary>
        public int Offset { get; private set; }

        /// <summary>The length of the frame's body [bytes].</summary>
        public int Count { get; private set; }

        /// <summary>Whether another part of the same message follows.</summary>
        public bool HasMore { get; private set; }

        /// <summary>Whether the frame is a command.</summary>
        public bool IsCommand { get; private set; }

        /// <summary>Why the bytes are not frames; "" if they are.</summary>
        public string Problem { get; private set; }

        /// <summary>Whether bytes have arrived since the last attempt to read a frame failed.</summary>
        public bool IsUnread { get; private set; }

        /// <summary>The size of the buffer [bytes].</summary>
        public int Capacity
        {
            get { return _data.Length; }
        }

        /// <summary>
        /// Makes room for new bytes in <see cref="Data"/>. Returns how many may be added; 0 if a whole frame waits to
        /// be read.
        /// </summary>
        public int Reserve(out int offset)
        {
            if (_start > 0 && (_start == _end || _end == _data.Length))
            {
                Buffer.BlockCopy(_data, _start, _data, 0, _end - _start);
                _end -= _start;
                _start = 0;
            }
            if (_end == _data.Length && _needed > _data.Length)
            {
                Array.Resize(ref _data, Math.Min(_needed, 2 * _data.Length));
            }
            offset = _end;
            return _data.Length - _end;
        }

        /// <summary>Adds bytes that were put where <see cref="Reserve"/> said.</summary>
        public void Add(int count)
        {
            _end += count;
            IsUnread = true;
        }

        /// <summary>The number of bytes that were added and not read.</summary>
        public int Waiting
        {
            get { return _end - _start; }
        }

        /// <summary>Returns a byte that was added and not read.</summary>
        public byte Peek(int index)
        {
            return _data[_start + index];
        }

        /// <summary>Skips bytes that were peeked at.</summary>
        public void Skip(int count)
        {
            _start += count;
        }

        /// <summary>Reads the next frame. Returns false if it has not arrived completely, or if there is a problem.</summary>
        public bool Read()
        {
            return IsUnread = ReadFrame();
        }

        private bool ReadFrame()
        {
            if (Problem.Length > 0 || _start == _end)
            {
                return false;
            }
            int flags = _data[_start];
            IsCommand = (flags & Frame.Command) != 0;
            HasMore = (flags & Frame.More) != 0;
            if ((flags & Frame.Reserved) != 0 || IsCommand && HasMore)
            {
                Problem = "a frame has the flags " + flags;
                return false;
            }
            int head = (flags & Frame.Long) != 0 ? 9 : 2;
            if (_end - _start < head)
            {
                return false;
            }
            ulong size = head == 2 ? _data[_start + 1] : ReadLong(_start + 1);
            int most = IsCommand ? _maxCommand : _maxMessage;
            if (size > (ulong)most)
            {
                Problem = "a frame of " + size + " bytes, where at most " + most + " are accepted";
                return false;
            }
            _needed = head + (int)size;
            if (_end - _start < _needed)
            {
                return false;
            }
            Offset = _start + head;
            Count = (int)size;
            _start += _needed;
            _needed = 0;
            return true;
        }

        private ulong ReadLong(int at)
        {
            ulong value = 0;
            for (int i = 0; i < 8; i++)
            {
                value = value << 8 | _data[at + i];
            }
            return value;
        }
    }
}
