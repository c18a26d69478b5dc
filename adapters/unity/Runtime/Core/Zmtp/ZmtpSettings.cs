using System.Collections.Generic;

namespace Pacinian.Zmtp
{
    /// <summary>The kinds of sockets that this client has.</summary>
    internal enum SocketKind
    {
        Dealer,
        Sub,
    }

    /// <summary>How a socket speaks with its peer.</summary>
    internal sealed class ZmtpSettings
    {
        public SocketKind Kind;

        /// <summary>For PLAIN; null: NULL, without a name and password.</summary>
        public string User, Password;

        /// <summary>The largest part of a message that is accepted [bytes].</summary>
        public int MaxMessage = 1 << 20;

        /// <summary>Within which TCP must connect, and after that the peer must have shaken hands [s].</summary>
        public double ConnectTimeout = 2.0, HandshakeTimeout = 2.0;

        /// <summary>Between two heartbeats [s]; 0: none are sent, but the peer's are answered.</summary>
        public double PingInterval;

        /// <summary>How long a peer may be silent after a heartbeat, here and there [s].</summary>
        public double PingTimeout = 1.5;

        /// <summary>Frames that wait to be sent before no more messages are taken.</summary>
        public int SendLimit = 16;

        /// <summary>What a subscriber wants: beginnings of messages.</summary>
        public readonly List<byte[]> Topics = new List<byte[]>();

        /// <summary>Takes one of the topics away; false if there is none that is equal.</summary>
        public bool Remove(byte[] topic)
        {
            int at = Topics.FindIndex(each => Begins(each, 0, each.Length, topic) && each.Length == topic.Length);
            if (at >= 0)
            {
                Topics.RemoveAt(at);
            }
            return at >= 0;
        }

        /// <summary>Whether a message that begins with these bytes is wanted.</summary>
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
