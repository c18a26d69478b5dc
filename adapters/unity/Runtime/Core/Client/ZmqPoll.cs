using System;
using System.Runtime.InteropServices;

namespace Pacinian
{
    /// <summary>The sockets that libzmq waits for, in the memory layout of its zmq_pollitem_t.</summary>
    internal sealed class ZmqPoll : IDisposable
    {
        private static readonly int Descriptor = Environment.OSVersion.Platform == PlatformID.Win32NT ? IntPtr.Size : 4;
        private static readonly int Wanted = IntPtr.Size + Descriptor; // offset of the requested events; the reported ones follow
        private static readonly int Size = (Wanted + 4 + IntPtr.Size - 1) / IntPtr.Size * IntPtr.Size;

        private readonly int _most;
        private IntPtr _items;
        private int _count;

        public ZmqPoll(int most)
        {
            _most = most;
            _items = Marshal.AllocHGlobal(most * Size);
        }

        public void Clear()
        {
            _count = 0;
        }

        /// <summary>Adds a socket to wait for messages. room: also waits for room to send one.</summary>
        public void Add(IntPtr socket, bool room)
        {
            if (_count == _most)
            {
                throw new InvalidOperationException("no more sockets can be waited for");
            }
            for (int i = 0; i < Size; i++)
            {
                Marshal.WriteByte(_items, _count * Size + i, 0);
            }
            Marshal.WriteIntPtr(_items, _count * Size, socket);
            Marshal.WriteInt16(_items, _count * Size + Wanted, room ? (short)(LibZmq.In | LibZmq.Out) : LibZmq.In);
            _count++;
        }

        /// <summary>Waits for any of the sockets, for this time at most [ms]. Returns false on an error.</summary>
        public bool Wait(int milliseconds)
        {
            return LibZmq.zmq_poll(_items, _count, (IntPtr)milliseconds) >= 0;
        }

        public void Dispose()
        {
            Marshal.FreeHGlobal(_items);
            _items = IntPtr.Zero;
            _count = 0;
        }
    }
}
