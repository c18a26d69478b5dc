using System;
using System.Runtime.InteropServices;
using System.Text;

namespace Pacinian
{
    /// <summary>
    /// The part of libzmq's C interface that the client uses. Unity finds a native plug-in of that name. .NET and Mono
    /// look for libzmq.dll, libzmq.so or libzmq.dylib; Pacinian.dll.config can give Mono another name.
    /// </summary>
    internal static class LibZmq
    {
        public const int Pair = 0, Subscriber = 2, Dealer = 5;
        public const int Subscribe = 6, More = 13, Events = 15, Linger = 17, ReconnectInterval = 18;
        public const int LongestMessage = 22, SendRoom = 23, ReceiveRoom = 24, Immediate = 39, Ipv6 = 42;
        public const int CurvePublicKey = 48, CurveSecretKey = 49, CurveServerKey = 50;
        public const int HandshakeTimeout = 66, ConnectTimeout = 79;
        public const int HeartbeatInterval = 75, HeartbeatTtl = 76, HeartbeatTimeout = 77;
        public const int DontWait = 1;
        public const short In = 1, Out = 2;
        public const int Closed = 0x80, Disconnected = 0x200;
        public const int FailedNoDetail = 0x800, Connected = 0x1000, FailedProtocol = 0x2000, FailedAuth = 0x4000;

        private const string Library = "libzmq";

        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        public static extern IntPtr zmq_ctx_new();

        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        public static extern int zmq_ctx_term(IntPtr context);

        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        public static extern IntPtr zmq_socket(IntPtr context, int type);

        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        public static extern int zmq_close(IntPtr socket);

        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        public static extern int zmq_connect(IntPtr socket, byte[] address);

        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        public static extern int zmq_bind(IntPtr socket, byte[] address);

        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        public static extern int zmq_send(IntPtr socket, byte[] data, UIntPtr count, int flags);

        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        public static extern int zmq_recv(IntPtr socket, byte[] into, UIntPtr count, int flags);

        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        public static extern int zmq_poll(IntPtr items, int count, IntPtr milliseconds);

        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        public static extern int zmq_socket_monitor(IntPtr socket, byte[] address, int events);

        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        public static extern int zmq_setsockopt(IntPtr socket, int option, byte[] value, UIntPtr count);

        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        public static extern int zmq_setsockopt(IntPtr socket, int option, ref int value, UIntPtr count);

        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        public static extern int zmq_setsockopt(IntPtr socket, int option, ref long value, UIntPtr count);

        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        public static extern int zmq_getsockopt(IntPtr socket, int option, ref int value, ref UIntPtr count);

        /// <summary>Returns a text as a null-terminated string.</summary>
        public static byte[] Text(string text)
        {
            return Encoding.UTF8.GetBytes(text + "\0");
        }
    }
}
