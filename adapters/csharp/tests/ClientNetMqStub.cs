using System;

// The part of NetMQ 4.0.1's interface that the client uses, so that its transport is compiled. It does nothing.
namespace NetMQ
{
    [Flags]
    public enum PollEvents
    {
        None = 0,
        PollIn = 1,
        PollOut = 2,
    }

    public class NetMQException : Exception
    {
    }

    public class NetMQCertificate
    {
        public NetMQCertificate(byte[] secretKey, byte[] publicKey)
        {
        }
    }

    public class SocketOptions
    {
        public TimeSpan Linger { get; set; }

        public TimeSpan ReconnectInterval { get; set; }

        public TimeSpan HeartbeatInterval { get; set; }

        public TimeSpan HeartbeatTimeout { get; set; }

        public long MaxMsgSize { get; set; }

        public int SendHighWatermark { get; set; }

        public bool DelayAttachOnConnect { get; set; }

        public byte[] CurveServerKey { get; set; }

        public NetMQCertificate CurveCertificate { get; set; }
    }

    public interface IOutgoingSocket
    {
    }

    public interface IReceivingSocket
    {
    }

    public abstract class NetMQSocket : IOutgoingSocket, IReceivingSocket, IDisposable
    {
        public SocketOptions Options { get; } = new SocketOptions();

        public bool HasOut
        {
            get { return false; }
        }

        public void Connect(string address)
        {
        }

        public void Dispose()
        {
        }
    }

    public static class Extensions
    {
        public static bool TrySendFrame(
            this IOutgoingSocket socket, TimeSpan timeout, byte[] data, int length, bool more = false)
        {
            return false;
        }

        public static bool TryReceiveFrameBytes(this IReceivingSocket socket, out byte[] bytes, out bool more)
        {
            return socket.TryReceiveFrameBytes(TimeSpan.Zero, out bytes, out more);
        }

        public static bool TryReceiveFrameBytes(
            this IReceivingSocket socket, TimeSpan timeout, out byte[] bytes, out bool more)
        {
            bytes = null;
            more = false;
            return false;
        }
    }

    public sealed class NetMQSelector
    {
        public bool Select(Item[] items, int itemsCount, long timeout)
        {
            return false;
        }

        public sealed class Item
        {
            public Item(NetMQSocket socket, PollEvents @event)
            {
            }
        }
    }
}

namespace NetMQ.Sockets
{
    public class DealerSocket : NetMQSocket
    {
    }

    public class SubscriberSocket : NetMQSocket
    {
        public void Subscribe(string topic)
        {
        }
    }

    public class PairSocket : NetMQSocket
    {
        public static void CreateSocketPair(out PairSocket socket1, out PairSocket socket2)
        {
            socket1 = new PairSocket();
            socket2 = new PairSocket();
        }
    }
}
