using System.Collections.Generic;

namespace Pacinian.Zmtp
{
    /// <summary>The kinds of sockets that the client has.</summary>
    internal enum SocketKind
    {
        Dealer,
        Sub,
    }

    /// <summary>The settings of a socket.</summary>
    internal sealed class ZmtpSettings
    {
        /// <summary>The time for TCP to connect, and for the handshake after that [s].</summary>
        public const double DefaultTimeout = 2.0;

        public SocketKind Kind;

        /// <summary>For PLAIN; null: NULL, without a name and password.</summary>
        public string User, Password;

        /// <summary>The largest accepted part of a message [bytes].</summary>
        public int MaxMessage = 1 << 20;

        /// <summary>Time limits for TCP's connection, and then for the handshake [s].</summary>
        public double ConnectTimeout = DefaultTimeout, HandshakeTimeout = DefaultTimeout;

        /// <summary>The time between two heartbeats [s]; 0: none are sent, but the peer's are answered.</summary>
        public double PingInterval;

        /// <summary>The longest silence of a peer after a heartbeat [s]. Needed if any are sent.</summary>
        public double PingTimeout;

        /// <summary>The number of waiting frames beyond which messages are not accepted.</summary>
        public int SendLimit = 16;

        /// <summary>The prefixes of messages to which a subscriber subscribes.</summary>
        public readonly List<byte[]> Topics = new List<byte[]>();

        /// <summary>Returns whether a message with these first bytes is wanted.</summary>
        public bool IsWanted(byte[] data, int offset, int count)
        {
            for (int i = 0; i < Topics.Count; i++)
            {
                if (Begins(data, offset, count, Topics[i]))
                {
                    return true;
                }
            }
            return Kind != SocketKind.Sub;
        }

        private static bool Begins(byte[] data, int offset, int count, byte[] topic)
        {
            bool same = topic.Length <= count;
            for (int i = 0; i < topic.Length && same; i++)
            {
                same = data[offset + i] == topic[i];
            }
            return same;
        }
    }
}
