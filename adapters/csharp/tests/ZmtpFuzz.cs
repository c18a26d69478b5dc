using System;
using System.Collections.Generic;
using System.Text;
using Pacinian.Zmtp;

namespace Pacinian.Tests
{
    /// <summary>
    /// Feeds tampered or random bytes of a peer in parts of any size: no exception, bounded memory, and an end.
    /// Arguments: seed, number of conversations.
    /// </summary>
    internal sealed class ZmtpFuzz
    {
        private const int MaxMessage = 20000;

        private readonly Random _random;
        private readonly byte[] _into = new byte[MaxMessage];
        private readonly Dictionary<string, int> _ends = new Dictionary<string, int>();

        private ZmtpFuzz(int seed)
        {
            _random = new Random(seed);
        }

        private static int Main(string[] arguments)
        {
            ZmtpFuzz fuzz = new ZmtpFuzz(int.Parse(arguments[0]));
            int count = int.Parse(arguments[1]);
            for (int i = 0; i < count; i++)
            {
                fuzz.Converse();
            }
            foreach (KeyValuePair<string, int> each in fuzz._ends)
            {
                Console.Out.WriteLine(each.Value + " " + each.Key);
            }
            Console.Out.WriteLine(count + " conversations");
            return 0;
        }

        private void Converse()
        {
            bool plain = _random.Next(2) == 0;
            ZmtpSettings settings = new ZmtpSettings
            {
                Kind = _random.Next(2) == 0 ? SocketKind.Dealer : SocketKind.Sub,
                User = plain ? "pacinian" : null,
                Password = plain ? "token" : null,
                MaxMessage = MaxMessage,
                PingInterval = _random.Next(2) * 0.05,
                PingTimeout = 1.5,
            };
            settings.Topics.Add(Encoding.ASCII.GetBytes("state"));
            byte[] bytes = Tamper(Transcript(settings));
            ZmtpConnection made = new ZmtpConnection(settings, 0.0);
            int messages = Feed(made, bytes);
            made.NoteClosed();
            while (made.Read(_into) >= 0)
            {
                messages++;
            }
            if (made.Ending == Ending.None || made.HasRoom)
            {
                throw new Exception("it goes on after its end");
            }
            string end = made.Ending + (messages > 0 ? " after messages" : made.Established ? " after the handshake" : " in the handshake");
            int known;
            _ends.TryGetValue(end, out known);
            _ends[end] = known + 1;
        }

        /// <summary>Feeds bytes. Returns how many messages were read.</summary>
        private int Feed(ZmtpConnection made, byte[] bytes)
        {
            int messages = 0, at = 0;
            double now = 0.0;
            int largest = _random.Next(3) == 0 ? 1 : _random.Next(1, 5000);
            while (at < bytes.Length && made.Ending == Ending.None)
            {
                now += 0.001;
                int offset, count = made.Input.Reserve(out offset);
                count = Math.Min(Math.Min(count, bytes.Length - at), _random.Next(1, largest + 1));
                Array.Copy(bytes, at, made.Input.Data, offset, count);
                made.Input.Add(count);
                at += count;
                made.NoteArrival(now);
                int read, left = messages + bytes.Length; // a frame has at least two bytes
                while ((read = made.Read(_into)) >= 0)
                {
                    messages++;
                    if (read > MaxMessage || messages > left)
                    {
                        throw new Exception("a message of " + read + " bytes, of " + messages);
                    }
                }
                made.CheckTime(now);
                made.Send(_into, _random.Next(100));
                if (_random.Next(2) == 0)
                {
                    made.Output.MarkSent(_random.Next(made.Output.Count + 1));
                }
                if (made.Input.Capacity > Math.Max(8192, Math.Min(MaxMessage + 9, 2 * at)) || made.Output.Count > 100000)
                {
                    throw new Exception(made.Input.Capacity + " bytes for " + at + " that came, " + made.Output.Count + " to be sent");
                }
            }
            return messages;
        }

        /// <summary>Returns what a well-behaved server sends.</summary>
        private byte[] Transcript(ZmtpSettings settings)
        {
            FrameWriter said = new FrameWriter();
            byte[] greeting = new byte[64];
            greeting[0] = 0xff;
            greeting[9] = 0x7f;
            greeting[10] = 3;
            greeting[11] = (byte)_random.Next(2);
            string mechanism = settings.User == null ? "NULL" : "PLAIN";
            Encoding.ASCII.GetBytes(mechanism, 0, mechanism.Length, greeting, 12);
            said.WriteRaw(greeting);
            if (settings.User != null)
            {
                said.WriteCommand(Command.Welcome, greeting, 0);
            }
            byte[] properties = Command.WriteProperties(
                "Socket-Type", settings.Kind == SocketKind.Sub ? "PUB" : "ROUTER", "Identity", "", "X-Else", "anything");
            said.WriteCommand(Command.Ready, properties, properties.Length);
            byte[] body = new byte[MaxMessage];
            Encoding.ASCII.GetBytes("state", 0, 5, body, 0);
            for (int i = _random.Next(20); i > 0; i--)
            {
                switch (_random.Next(4))
                {
                    case 0: said.WriteCommand(Command.Ping, new byte[] { 0, 200, 1, 2, 3 }, _random.Next(2, 6)); break;
                    case 1: said.WriteCommand(Command.Pong, body, _random.Next(17)); break;
                    case 2: said.WriteMessage(body, _random.Next(300)); break;
                    default: said.WriteMessage(body, _random.Next(MaxMessage + 1)); break;
                }
            }
            byte[] bytes = new byte[said.Count];
            Array.Copy(said.Data, said.Offset, bytes, 0, bytes.Length);
            return bytes;
        }

        private byte[] Tamper(byte[] bytes)
        {
            List<byte> made = new List<byte>(bytes);
            int head = Math.Min(200, made.Count);
            for (int i = _random.Next(4); i > 0; i--)
            {
                int at = _random.Next(_random.Next(2) == 0 ? head : made.Count);
                at = Math.Min(at, made.Count - 1);
                switch (_random.Next(6))
                {
                    case 0: made[at] = (byte)_random.Next(256); break;
                    case 1: made[at] ^= (byte)(1 << _random.Next(8)); break;
                    case 2: made.RemoveRange(at, made.Count - at); break;
                    case 3: made.RemoveAt(at); break;
                    case 4: made.InsertRange(at, Noise(_random.Next(1, 40))); break;
                    default: made.InsertRange(at, Announcement()); break;
                }
                if (made.Count == 0)
                {
                    break;
                }
            }
            if (_random.Next(20) == 0)
            {
                return Noise(_random.Next(3000));
            }
            return made.ToArray();
        }

        private byte[] Noise(int count)
        {
            byte[] made = new byte[count];
            _random.NextBytes(made);
            return made;
        }

        /// <summary>Returns the head of a large frame.</summary>
        private byte[] Announcement()
        {
            byte[] made = Noise(9);
            made[0] = (byte)(2 + 4 * _random.Next(2) + _random.Next(2));
            for (int i = 1; i < 9 - _random.Next(1, 9); i++)
            {
                made[i] = 0;
            }
            return made;
        }
    }
}
