using System;
using System.Text;
using Pacinian.Wire;

namespace Pacinian
{
    /// <summary>A socket of libzmq that never blocks. Belongs to one thread. Close it before its context.</summary>
    internal sealed class ZmqSocket
    {
        private const int MaxWaitingMessages = 1000; // messages that wait to be read
        private const int Waiting = 16; // messages that wait to be sent

        private readonly byte[] _event = new byte[6];
        private readonly byte[] _skipped = new byte[256];
        private IntPtr _monitor;

        public ZmqSocket(IntPtr context, int type)
        {
            Handle = LibZmq.zmq_socket(context, type);
            Set(LibZmq.Linger, 0);
        }

        public IntPtr Handle { get; private set; }

        /// <summary>Whether a wait ends when there is room to send.</summary>
        public bool Full { get; set; }

        public IntPtr Monitor
        {
            get { return _monitor; }
        }

        public bool Valid
        {
            get { return Handle != IntPtr.Zero; }
        }

        /// <summary>Sets the options and keys of all sockets to a server. Returns false if the connection has no valid keys.</summary>
        public bool Secure(ConnectionFile file)
        {
            Set(LibZmq.SendRoom, Waiting);
            Set(LibZmq.ReceiveRoom, MaxWaitingMessages);
            const int timeoutMs = (int)(1e3 * Zmtp.ZmtpSettings.DefaultTimeout);
            Set(LibZmq.HandshakeTimeout, timeoutMs); // [ms], like all below
            Set(LibZmq.ConnectTimeout, timeoutMs);
            long longest = Protocol.MaxReplyBytes;
            LibZmq.zmq_setsockopt(Handle, LibZmq.LongestMessage, ref longest, (UIntPtr)8);
            return file.ServerKey.Length > 0
                && Set(LibZmq.CurveServerKey, file.ServerKey)
                && Set(LibZmq.CurvePublicKey, file.PublicKey)
                && Set(LibZmq.CurveSecretKey, file.SecretKey);
        }

        /// <summary>Makes the socket accept messages only while it is connected, connect only once, and report its end.</summary>
        public void Once(IntPtr context, string monitor, bool heartbeat)
        {
            Set(LibZmq.Immediate, 1);
            Set(LibZmq.ReconnectInterval, -1);
            if (heartbeat)
            {
                Set(LibZmq.HeartbeatInterval, Protocol.HeartbeatIntervalMs);
                Set(LibZmq.HeartbeatTtl, Protocol.HeartbeatTimeoutMs);
                Set(LibZmq.HeartbeatTimeout, Protocol.HeartbeatTimeoutMs);
                Set(LibZmq.ReceiveRoom, 0); // no limit: at a limit, libzmq 4.3 aborts the process if a heartbeat is due
            }
            const int events = LibZmq.Connected | LibZmq.Closed | LibZmq.Disconnected
                | LibZmq.FailedNoDetail | LibZmq.FailedProtocol | LibZmq.FailedAuth;
            byte[] at = LibZmq.Text(monitor);
            LibZmq.zmq_socket_monitor(Handle, at, events);
            _monitor = LibZmq.zmq_socket(context, LibZmq.Pair);
            int none = 0;
            LibZmq.zmq_setsockopt(_monitor, LibZmq.Linger, ref none, (UIntPtr)4);
            LibZmq.zmq_connect(_monitor, at);
        }

        /// <summary>Connects to an address. Returns false if the address is not valid.</summary>
        public bool Connect(string address)
        {
            Set(LibZmq.Ipv6, address.IndexOf('[') >= 0 ? 1 : 0);
            return LibZmq.zmq_connect(Handle, LibZmq.Text(address)) == 0;
        }

        public bool Set(int option, int value)
        {
            return LibZmq.zmq_setsockopt(Handle, option, ref value, (UIntPtr)4) == 0;
        }

        public bool Set(int option, string value)
        {
            byte[] data = Encoding.UTF8.GetBytes(value);
            return LibZmq.zmq_setsockopt(Handle, option, data, (UIntPtr)data.Length) == 0;
        }

        /// <summary>Returns an integer option; 0 if it cannot be read.</summary>
        public int Get(int option)
        {
            int value = 0;
            UIntPtr count = (UIntPtr)4;
            return LibZmq.zmq_getsockopt(Handle, option, ref value, ref count) == 0 ? value : 0;
        }

        public bool Room()
        {
            Full = (Get(LibZmq.Events) & LibZmq.Out) == 0;
            return !Full;
        }

        public bool Send(byte[] data, int count)
        {
            Full = LibZmq.zmq_send(Handle, data, (UIntPtr)count, LibZmq.DontWait) != count;
            return !Full;
        }

        /// <summary>Receives the last part of the next message. Returns its length; -1 if there is none.</summary>
        public int Receive(byte[] into)
        {
            int count;
            do
            {
                count = LibZmq.zmq_recv(Handle, into, (UIntPtr)into.Length, LibZmq.DontWait);
            }
            while (count >= 0 && Get(LibZmq.More) != 0);
            return Math.Min(count, into.Length);
        }

        /// <summary>Returns how the connection has ended, from the monitor's events.</summary>
        public Ending Ended()
        {
            for (int told = Told(); told != 0; told = Told())
            {
                if ((told & LibZmq.FailedAuth) != 0)
                {
                    return Ending.Denied;
                }
                if ((told & (LibZmq.FailedProtocol | LibZmq.FailedNoDetail)) != 0)
                {
                    return Ending.Foreign;
                }
                if ((told & (LibZmq.Closed | LibZmq.Disconnected)) != 0)
                {
                    return (told & LibZmq.Closed) != 0 ? Ending.Nobody : Ending.Gone;
                }
            }
            return Ending.None;
        }

        public void Close()
        {
            if (_monitor != IntPtr.Zero)
            {
                LibZmq.zmq_socket_monitor(Handle, null, 0);
                LibZmq.zmq_close(_monitor);
                _monitor = IntPtr.Zero;
            }
            if (Valid)
            {
                LibZmq.zmq_close(Handle);
                Handle = IntPtr.Zero;
            }
        }

        private int Told()
        {
            if (_monitor == IntPtr.Zero
                || LibZmq.zmq_recv(_monitor, _event, (UIntPtr)_event.Length, LibZmq.DontWait) < 2)
            {
                return 0;
            }
            LibZmq.zmq_recv(_monitor, _skipped, (UIntPtr)_skipped.Length, LibZmq.DontWait);
            return _event[0] | _event[1] << 8;
        }
    }
}
