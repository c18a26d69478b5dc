using System;
using System.Collections.Generic;
using System.Net;
using System.Net.Sockets;
using System.Text;
using System.Threading;
using Pacinian.Zmtp;

namespace Pacinian.Tests
{
    /// <summary>
    /// Tests of ZMTP with bytes written by hand from RFC 37, 24 and 23. Quoted text stands for its bytes; the rest is
    /// hexadecimal.
    /// </summary>
    internal sealed class ClientUnitZmtp
    {
        private const string Zeros = "000000000000000000000000000000";
        private const string Greeting31 = "ff 0000000000000000 7f 0301";
        private const string Null = "'NULL' 00000000 000000000000000000000000";
        private const string Plain = "'PLAIN' " + Zeros;
        private const string Filler = "00" + Zeros + Zeros + "00";
        private const string RouterReady = "04 1c 05'READY' 0b'Socket-Type' 00000006'ROUTER'";
        private const string PubReady = "04 19 05'READY' 0b'Socket-Type' 00000003'PUB'";

        private readonly byte[] _into = new byte[1 << 16];

        public void TheHandshakeOfNull()
        {
            ZmtpConnection made = new ZmtpConnection(new ZmtpSettings(), 0.0);
            Sends(made, Greeting31 + Null + Filler);
            Gives(made, Greeting31 + Null + Filler);
            Sends(made, "04 29 05'READY' 0b'Socket-Type' 00000006'DEALER' 08'Identity' 00000000");
            ClientUnit.Holds(!made.Established && !made.HasRoom);
            Gives(made, RouterReady);
            ClientUnit.Holds(made.Established && made.HasRoom);
            Sends(made, "");
        }

        public void TheHandshakeOfPlain()
        {
            ZmtpConnection made = new ZmtpConnection(new ZmtpSettings { User = "admin", Password = "secret" }, 0.0);
            Sends(made, Greeting31 + Plain + Filler);
            Gives(made, Greeting31 + Plain + "01" + Filler.Substring(2));
            Sends(made, "04 13 05'HELLO' 05'admin' 06'secret'");
            Gives(made, "04 08 07'WELCOME'");
            Sends(made, "04 2c 08'INITIATE' 0b'Socket-Type' 00000006'DEALER' 08'Identity' 00000000");
            Gives(made, RouterReady);
            ClientUnit.Holds(made.Established);
        }

        public void WhyAPeerIsRefused()
        {
            Ends(Ending.Foreign, "not ZMTP", "'HTTP/1.1 400'");
            Ends(Ending.Foreign, "not ZMTP", "ff 0000000000000000 7e");
            Ends(Ending.Foreign, "older than 3.0", "ff 0000000000000000 7f 01");
            Ends(Ending.Foreign, "older than 3.0", "ff 0000000000000000 7f 02");
            Ends(Ending.Foreign, "mechanism", Greeting31 + "'NULL'");
            Ends(Ending.Foreign, "mechanism", Greeting31 + "'PLAINX'");
            Ends(Ending.Foreign, "does not belong", Greeting31 + Plain + Filler + RouterReady);
            Ends(Ending.Foreign, "does not belong", Greeting31 + Plain + Filler + "00 01 41");
            Ends(Ending.Foreign, "does not belong", Greeting31 + Plain + Filler + "04 09 07'WELCOME' 00");
            Ends(Ending.Foreign, "full", Greeting31 + Plain + Filler + "04 0b 05'ERROR' 04'full'");
            Ends(Ending.Foreign, "cannot be read", Greeting31 + Plain + Filler + "04 0b 05'ERROR' 05'full'");
            Ends(Ending.Foreign, "a?[31mb?", Greeting31 + Plain + Filler + "04 0f 05'ERROR' 08'a' 1b '[31mb' 0a");
            Ends(Ending.Denied, "400", Greeting31 + Plain + Filler + "04 0a 05'ERROR' 03'400'");
            Ends(Ending.Denied, "400", Greeting31 + Plain + Filler + "04 09 '^RROR' 03'400'"); // as libzmq writes it
            Ends(Ending.Foreign, "of type PUB", Greeting31 + Plain + Filler + "04 08 07'WELCOME'" + PubReady);
            Ends(Ending.Foreign, "of type", Greeting31 + Plain + Filler + "04 08 07'WELCOME' 04 06 05'READY'");
            Ends(Ending.Foreign, "cut off", Greeting31 + Plain + Filler + "04 08 07'WELCOME' 04 08 05'READY' 0b41");
            Ends(Ending.Foreign, "cut off", Greeting31 + Plain + Filler + "04 08 07'WELCOME' 04 0d 05'READY' 01'A' ffffffff 00");
            Ends(Ending.Foreign, "cut off", Greeting31 + Plain + Filler + "04 08 07'WELCOME' 04 0d 05'READY' 01'A' 00000002 00");
            Ends(Ending.Foreign, "where at most 4096", Greeting31 + Plain + Filler + "06 0000000000001001");
        }

        public void ASubscriberRefusesWhatIsNoPublisher()
        {
            ZmtpConnection made = new ZmtpConnection(new ZmtpSettings { Kind = SocketKind.Sub }, 0.0);
            Gives(made, Greeting31 + Null + Filler + RouterReady);
            ClientUnit.Equal(Ending.Foreign, made.Ending);
            ClientUnit.Holds(made.Problem.Contains("of type ROUTER"));
        }

        public void ANewerPeerIsAccepted()
        {
            ZmtpConnection made = new ZmtpConnection(new ZmtpSettings { Kind = SocketKind.Sub }, 0.0);
            Gives(made, "ff 0102030405060708 7f 0400" + Null + Filler + "04 1a 05'READY' 0b'sOCKET-tYPE' 00000004'XPUB'");
            ClientUnit.Holds(made.Established);
        }

        public void FramesThatAreSent()
        {
            ZmtpConnection made = Connected(SocketKind.Dealer);
            made.Send(new byte[0], 0);
            made.Send(Encoding.ASCII.GetBytes("abcd"), 3);
            Sends(made, "00 00 00 03 'abc'");
            made.Send(new byte[256], 255);
            Sends(made, "00 ff" + new string('0', 510));
            made.Send(new byte[256], 256);
            Sends(made, "02 0000000000000100" + new string('0', 512));
            made.Send(new byte[70000], 70000);
            Sends(made, "02 0000000000011170" + new string('0', 140000));
        }

        public void FramesThatCome()
        {
            ZmtpConnection made = Connected(SocketKind.Dealer);
            Gives(made, "00 03 'abc' 00 00 02 0000000000000002 'de'");
            Reads(made, "'abc'", "", "'de'");
            Gives(made, "01 01 'a' 03 0000000000000001 'b' 04 05 04'NEWS' 00 01 'c'"); // a message of three parts, and a command in it
            Reads(made, "'c'");
            foreach (byte each in Bytes("02 0000000000000100" + new string('7', 512)))
            {
                Reads(made);
                Gives(made, new[] { each });
            }
            Reads(made, new string('7', 512));
            ClientUnit.Equal(Ending.None, made.Ending);
        }

        public void OfAMessageThatIsTooLongForTheReceiverTheBeginningIsRead()
        {
            ZmtpConnection made = Connected(SocketKind.Dealer);
            Gives(made, "00 04 'abcd'");
            ClientUnit.Equal(2, made.Read(new byte[2]));
        }

        public void FramesThatAreNone()
        {
            foreach (string wrong in new[] { "05 00", "08 00", "80", "ff 00", "07 00" })
            {
                ZmtpConnection made = Connected(SocketKind.Dealer);
                Gives(made, wrong);
                Reads(made);
                ClientUnit.Equal(Ending.Foreign, made.Ending);
                ClientUnit.Holds(made.Problem.Contains("flags"));
            }
        }

        public void WhatIsAnnouncedTakesNoMemory()
        {
            foreach (string size in new[] { "0000000000100001", "000000007fffffff", "7fffffffffffffff", "ffffffffffffffff" })
            {
                ZmtpConnection made = Connected(SocketKind.Dealer);
                Gives(made, "02" + size);
                Reads(made);
                ClientUnit.Equal(Ending.Foreign, made.Ending);
                ClientUnit.Holds(made.Problem.Contains("where at most 1048576"));
            }
            ZmtpConnection allowed = Connected(SocketKind.Dealer);
            int before = allowed.Input.Capacity;
            Gives(allowed, "02 0000000000100000" + new string('0', 2000));
            Reads(allowed);
            ClientUnit.Equal(before, allowed.Input.Capacity);
            Gives(allowed, new byte[1048576 - 1000]);
            ClientUnit.Equal(_into.Length, allowed.Read(_into));
            ClientUnit.Equal(1048576 + 9, allowed.Input.Capacity);
        }

        public void AHeartbeatIsAnswered()
        {
            ZmtpConnection made = Connected(SocketKind.Dealer);
            Gives(made, "04 07 04'PING' 0000 04 0a 04'PING' 0000 'abc'");
            Reads(made);
            Sends(made, "04 05 04'PONG' 04 08 04'PONG' 'abc'");
            Gives(made, "04 17 04'PING' 0000 '0123456789abcdef'");
            Reads(made);
            Sends(made, "04 15 04'PONG' '0123456789abcdef'");
            Gives(made, "04 18 04'PING' 0000 '0123456789abcdefg'");
            Reads(made);
            ClientUnit.Equal(Ending.Foreign, made.Ending);
        }

        public void AFloodOfHeartbeatsIsAnsweredOnlyUpToALimit()
        {
            ZmtpConnection made = Connected(SocketKind.Dealer);
            for (int i = 0; i < 10000; i++)
            {
                Gives(made, "04 07 04'PING' 0000");
                Reads(made);
            }
            ClientUnit.Equal(64, made.Output.Frames);
        }

        public void AfterAHeartbeatWithATimeToLiveSilenceIsTheEnd()
        {
            ZmtpConnection made = Connected(SocketKind.Dealer);
            Gives(made, "04 07 04'PING' 000a", 5.0);
            Reads(made);
            made.CheckTime(5.99);
            ClientUnit.Equal(Ending.None, made.Ending);
            made.CheckTime(6.01);
            ClientUnit.Equal(Ending.Gone, made.Ending);
        }

        public void AMessageFulfilsATimeToLive()
        {
            ZmtpConnection made = Connected(SocketKind.Dealer);
            Gives(made, "04 07 04'PING' 000a 04 07 04'PING' 0000 04 07 04'PING' 000a", 5.0);
            Reads(made);
            Gives(made, "00 00", 5.99);
            Reads(made, "");
            made.CheckTime(1e6);
            ClientUnit.Equal(Ending.None, made.Ending);
        }

        public void AMessageBehindAHeartbeatFulfilsItsTimeToLive()
        {
            ZmtpConnection made = Connected(SocketKind.Dealer);
            Gives(made, "04 07 04'PING' 000a 00 00", 5.0);
            Reads(made, "");
            made.CheckTime(1e6);
            ClientUnit.Equal(Ending.None, made.Ending);
        }

        public void APeerOf30IsSentNoHeartbeats()
        {
            ZmtpConnection made = new ZmtpConnection(new ZmtpSettings { PingInterval = 0.05, PingTimeout = 1.5 }, 0.0);
            Gives(made, "ff 0000000000000000 7f 0300" + Null + Filler + RouterReady);
            ClientUnit.Holds(made.Established);
            made.Output.MarkSent(made.Output.Count);
            made.CheckTime(0.1);
            Sends(made, "");
            made.CheckTime(10.0);
            ClientUnit.Equal(Ending.None, made.Ending);
        }

        public void AfterAnErrorNothingIsRead()
        {
            foreach (string fatal in new[] { "04 0b 05'ERROR' 04'over'", "04 18 04'PING' 0000 '0123456789abcdefg'" })
            {
                ZmtpConnection made = Connected(SocketKind.Dealer);
                Gives(made, "00 01 'a'" + fatal + "00 01 'b'");
                made.NoteClosed();
                Reads(made, "'a'");
                Reads(made);
                ClientUnit.Equal(Ending.Gone, made.Ending);
            }
        }

        public void AProgramThatStoodStillWhileItConnectedIsConnected()
        {
            const int patience = 100000; // [us] for a connection if the listener's queue has room
            TcpListener listener = new TcpListener(IPAddress.Loopback, 0);
            listener.Start(1);
            List<Socket> opened = new List<Socket>();
            Socket last;
            do
            {
                last = new Socket(AddressFamily.InterNetwork, SocketType.Stream, ProtocolType.Tcp) { Blocking = false };
                opened.Add(last);
                ClientUnit.Raises<SocketException>(() => last.Connect(listener.LocalEndpoint));
            }
            while (last.Poll(patience, SelectMode.SelectWrite));
            last.Close();
            using (AutoResetEvent wake = new AutoResetEvent(false))
            {
                double now = 0.0;
                ZmtpSocket socket = new ZmtpSocket(new ZmtpSettings(), (IPEndPoint)listener.LocalEndpoint, false, wake, () => now);
                for (int i = opened.Count; i > 0; i--) // those already connected, then the one that waited
                {
                    opened.Add(listener.AcceptSocket());
                }
                now = 1000.0;
                socket.Work();
                ClientUnit.Equal(Ending.None, socket.Ended);
                socket.Close();
            }
            opened.ForEach(each => each.Close());
            listener.Stop();
        }

        public void OurHeartbeats()
        {
            ZmtpConnection made = Connected(SocketKind.Dealer, new ZmtpSettings { PingInterval = 0.05, PingTimeout = 1.5 });
            made.CheckTime(0.04);
            Sends(made, "");
            made.CheckTime(0.05);
            Sends(made, "04 07 04'PING' 000f");
            made.CheckTime(0.11);
            Sends(made, "04 07 04'PING' 000f");
            Gives(made, "04 05 04'PONG'", 1.4);
            made.CheckTime(1.54);
            ClientUnit.Equal(Ending.None, made.Ending);
            made.CheckTime(1.6); // a waiting heartbeat prevents another
            ClientUnit.Equal(1, made.Output.Frames);
            made.CheckTime(3.03);
            ClientUnit.Equal(Ending.None, made.Ending);
            made.CheckTime(3.05);
            ClientUnit.Equal(Ending.Gone, made.Ending);
            ClientUnit.Holds(!made.HasRoom);
        }

        public void AHandshakeThatTakesTooLong()
        {
            ZmtpConnection made = new ZmtpConnection(new ZmtpSettings(), 1.0);
            made.CheckTime(2.9);
            ClientUnit.Equal(Ending.None, made.Ending);
            made.CheckTime(3.1);
            ClientUnit.Equal(Ending.Foreign, made.Ending);
        }

        public void HowAConnectionIsClosed()
        {
            ZmtpConnection made = new ZmtpConnection(new ZmtpSettings(), 0.0);
            made.NoteClosed();
            ClientUnit.Equal(Ending.Foreign, made.Ending);
            made = Connected(SocketKind.Dealer);
            Gives(made, "00 01 'a'");
            made.NoteClosed();
            ClientUnit.Equal(Ending.Gone, made.Ending);
            Reads(made, "'a'"); // received messages are still read
            made = Connected(SocketKind.Dealer);
            Gives(made, "04 0b 05'ERROR' 04'over'");
            Reads(made);
            ClientUnit.Equal(Ending.Gone, made.Ending);
            ClientUnit.Holds(made.Problem.Contains("over"));
        }

        public void SubscriptionsAreCommands()
        {
            ZmtpSettings settings = new ZmtpSettings { Kind = SocketKind.Sub };
            settings.Topics.Add(Bytes("'state'"));
            ZmtpConnection made = new ZmtpConnection(settings, 0.0);
            Gives(made, Greeting31 + Null + Filler + PubReady);
            Sends(made, Greeting31 + Null + Filler + "04 19 05'READY' 0b'Socket-Type' 00000003'SUB' 04 0f 09'SUBSCRIBE' 'state'");
            made.Subscribe(Bytes("'state'"), false);
            Sends(made, "04 0c 06'CANCEL' 'state'");
        }

        public void SubscriptionsAreMessagesToAPeerOf30()
        {
            ZmtpSettings settings = new ZmtpSettings { Kind = SocketKind.Sub };
            settings.Topics.Add(Bytes("'state'"));
            ZmtpConnection made = new ZmtpConnection(settings, 0.0);
            Gives(made, "ff 0000000000000000 7f 0300" + Null + Filler + PubReady);
            Sends(made, Greeting31 + Null + Filler + "04 19 05'READY' 0b'Socket-Type' 00000003'SUB' 00 06 01'state'");
            made.Subscribe(Bytes("'state'"), false);
            Sends(made, "00 06 00'state'");
        }

        public void OnlyWhatIsSubscribedIsRead()
        {
            ZmtpSettings settings = new ZmtpSettings { Kind = SocketKind.Sub };
            settings.Topics.Add(Bytes("'state'"));
            ZmtpConnection made = Connected(SocketKind.Sub, settings);
            Gives(made, "01 05'stale' 00 01 01 01 05'state' 00 01 02 01 04'stat' 00 01 03 00 06'states'");
            Reads(made, "02", "'states'");
        }

        public void MessagesAreTakenUpToALimit()
        {
            ZmtpConnection made = Connected(SocketKind.Dealer);
            for (int i = 0; i < 16; i++)
            {
                ClientUnit.Holds(made.HasRoom && made.Send(new byte[10], 10));
            }
            ClientUnit.Holds(!made.HasRoom && !made.Send(new byte[10], 10));
            made.Output.MarkSent(11);
            ClientUnit.Holds(!made.HasRoom);
            made.Output.MarkSent(1);
            ClientUnit.Holds(made.HasRoom && made.Send(new byte[10], 10));
            ClientUnit.Equal(16 * 12, made.Output.Count);
        }

        public void WhatWasReadFromTcpIsNotWaitedFor()
        {
            TcpListener listener = new TcpListener(IPAddress.Loopback, 0);
            listener.Start();
            using (AutoResetEvent wake = new AutoResetEvent(false))
            {
                ZmtpSocket socket = new ZmtpSocket(new ZmtpSettings(), (IPEndPoint)listener.LocalEndpoint, false, wake, SteadyClock.Now);
                using (Socket peer = listener.AcceptSocket())
                {
                    peer.Send(Bytes(Greeting31 + Null));
                    Until(() => Works(socket) && peer.Available >= 64);
                    ClientUnit.Holds(socket.Patience > 0.0); // a greeting in two parts: nothing to do
                    peer.Send(Bytes(Filler + RouterReady + "00 03 'abc' 00 01 'd'"));
                    Until(() => Works(socket) && socket.HasRoom && socket.Patience == 0.0);
                    Until(() => socket.Receive(_into) == 3);
                    ClientUnit.Holds(socket.Patience == 0.0 || socket.Receive(_into) == 1);
                    Until(() => socket.Receive(_into) < 0);
                    ClientUnit.Holds(socket.Patience > 0.0);
                }
                socket.Close();
                ClientUnit.Equal(-1, socket.Receive(_into));
            }
            listener.Stop();
        }

        public void Addresses()
        {
            ClientUnit.Equal("127.0.0.1:5555", Endpoint.Read("tcp://127.0.0.1:5555").ToString());
            ClientUnit.Equal("127.0.0.1:1", Endpoint.Read("tcp://localhost:1").ToString());
            ClientUnit.Equal("[::1]:5555", Endpoint.Read("tcp://[::1]:5555").ToString());
            foreach (string wrong in new[]
            {
                "", "nowhere", "tcp://", "tcp://:1", "tcp://127.0.0.1", "tcp://127.0.0.1:", "tcp://127.0.0.1:0", "tcp://127.0.0.1:65536",
                "tcp://127.0.0.1:-1", "tcp://127.0.0.1: 1", "tcp://::1:5", "tcp://[127.0.0.1]:5", "tcp://[::1:5", "ipc:///tmp/a:1",
                "tcp://a.example:5", "tcp://127.0.0.1:99999999999",
            })
            {
                ClientUnit.Holds(Endpoint.Read(wrong) == null);
            }
        }

        private static ZmtpConnection Connected(SocketKind kind, ZmtpSettings settings = null)
        {
            settings = settings ?? new ZmtpSettings();
            settings.Kind = kind;
            ZmtpConnection made = new ZmtpConnection(settings, 0.0);
            Gives(made, Greeting31 + Null + Filler + (kind == SocketKind.Sub ? PubReady : RouterReady));
            ClientUnit.Holds(made.Established);
            made.Output.MarkSent(made.Output.Count);
            return made;
        }

        private static void Ends(Ending ending, string problem, string sent)
        {
            byte[] bytes = Bytes(sent);
            for (int step = 1; step <= bytes.Length; step += bytes.Length - 1) // byte by byte, and all at once
            {
                ZmtpConnection made = new ZmtpConnection(new ZmtpSettings { User = "a", Password = "b" }, 0.0);
                for (int i = 0; i < bytes.Length; i += step)
                {
                    byte[] part = new byte[Math.Min(step, bytes.Length - i)];
                    Array.Copy(bytes, i, part, 0, part.Length);
                    Gives(made, part);
                }
                ClientUnit.Equal(ending, made.Ending);
                ClientUnit.Holds(made.Problem.Contains(problem));
                ClientUnit.Holds(!made.Established && !made.HasRoom);
            }
        }

        private static bool Works(ZmtpSocket socket)
        {
            socket.Work();
            return true;
        }

        private static void Until(Func<bool> done)
        {
            for (double end = SteadyClock.Now() + 60.0; !done(); Thread.Sleep(1))
            {
                ClientUnit.Holds(SteadyClock.Now() < end);
            }
        }

        private static void Gives(ZmtpConnection to, string text, double now = 0.0)
        {
            Gives(to, Bytes(text), now);
        }

        private static void Gives(ZmtpConnection to, byte[] bytes, double now = 0.0)
        {
            for (int at = 0; at < bytes.Length;)
            {
                int offset, count = Math.Min(bytes.Length - at, to.Input.Reserve(out offset));
                if (count == 0)
                {
                    ClientUnit.Equal(-1, to.Read(new byte[0])); // a frame that needs more room says so when it is looked at
                    count = Math.Min(bytes.Length - at, to.Input.Reserve(out offset));
                }
                ClientUnit.Holds(count > 0);
                Array.Copy(bytes, at, to.Input.Data, offset, count);
                to.Input.Add(count);
                at += count;
                to.NoteArrival(now);
                to.Advance();
            }
        }

        private static void Sends(ZmtpConnection from, string text)
        {
            byte[] found = new byte[from.Output.Count];
            Array.Copy(from.Output.Data, from.Output.Offset, found, 0, found.Length);
            from.Output.MarkSent(found.Length);
            ClientUnit.Equal(BitConverter.ToString(Bytes(text)), BitConverter.ToString(found));
        }

        private void Reads(ZmtpConnection from, params string[] texts)
        {
            foreach (string text in texts)
            {
                int count = from.Read(_into);
                ClientUnit.Holds(count >= 0);
                ClientUnit.Equal(BitConverter.ToString(Bytes(text)), BitConverter.ToString(_into, 0, count));
            }
            ClientUnit.Equal(-1, from.Read(_into));
        }

        private static byte[] Bytes(string text)
        {
            StringBuilder digits = new StringBuilder();
            string[] parts = text.Split('\'');
            for (int i = 0; i < parts.Length; i++)
            {
                digits.Append(i % 2 == 0
                    ? parts[i].Replace(" ", "")
                    : BitConverter.ToString(Encoding.ASCII.GetBytes(parts[i])).Replace("-", ""));
            }
            byte[] made = new byte[digits.Length / 2];
            for (int i = 0; i < made.Length; i++)
            {
                made[i] = Convert.ToByte(digits.ToString(2 * i, 2), 16);
            }
            return made;
        }
    }
}
