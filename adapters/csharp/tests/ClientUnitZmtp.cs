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
        private const string Filler = "00" + Zeros + Zeros + "00";
        private const string RouterReady = "04 1c 05'READY' 0b'Socket-Type' 00000006'ROUTER'";

        private readonly byte[] _into = new byte[1 << 16];

        public void BytesThatComeOneByOne()
        {
            ZmtpConnection made = new ZmtpConnection(new ZmtpSettings { User = "a", Password = "b" }, 0.0);
            string handshake = Greeting31 + "'PLAIN' " + Zeros + "01" + Filler.Substring(2) + "04 08 07'WELCOME'" + RouterReady;
            foreach (byte each in Bytes(handshake + "01 01 'a' 02 0000000000000100" + new string('7', 512)))
            {
                Reads(made);
                Gives(made, new[] { each });
            }
            Reads(made, new string('7', 512));
            ClientUnit.Equal(Ending.None, made.Ending);
        }

        public void OfAMessageThatIsTooLongForTheReceiverTheBeginningIsRead()
        {
            ZmtpConnection made = Connected();
            Gives(made, "00 04 'abcd'");
            ClientUnit.Equal(2, made.Read(new byte[2]));
        }

        public void WhatIsAnnouncedTakesNoMemory()
        {
            ZmtpConnection made = Connected();
            int before = made.Input.Capacity;
            Gives(made, "02 0000000000100000" + new string('0', 2000));
            Reads(made);
            ClientUnit.Equal(before, made.Input.Capacity);
            Gives(made, new byte[1048576 - 1000]);
            ClientUnit.Equal(_into.Length, made.Read(_into));
            ClientUnit.Equal(1048576 + 9, made.Input.Capacity);
        }

        public void AFloodOfHeartbeatsIsAnsweredOnlyUpToALimit()
        {
            ZmtpConnection made = Connected();
            for (int i = 0; i < 10000; i++)
            {
                Gives(made, "04 07 04'PING' 0000");
                Reads(made);
            }
            ClientUnit.Equal(64, made.Output.Frames);
        }

        public void AfterAHeartbeatWithATimeToLiveSilenceIsTheEnd()
        {
            ZmtpConnection made = Connected();
            Gives(made, "04 07 04'PING' 000a", 5.0);
            Reads(made);
            made.CheckTime(5.99);
            ClientUnit.Equal(Ending.None, made.Ending);
            made.CheckTime(6.01);
            ClientUnit.Equal(Ending.Gone, made.Ending);
        }

        public void AMessageFulfilsATimeToLive()
        {
            ZmtpConnection made = Connected();
            Gives(made, "04 07 04'PING' 000a 04 07 04'PING' 0000 04 07 04'PING' 000a", 5.0);
            Reads(made);
            Gives(made, "00 00", 5.99);
            Reads(made, "");
            made.CheckTime(1e6);
            ClientUnit.Equal(Ending.None, made.Ending);
        }

        public void AMessageBehindAHeartbeatFulfilsItsTimeToLive()
        {
            ZmtpConnection made = Connected();
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
            ZmtpConnection made = Connected(new ZmtpSettings { PingInterval = 0.05, PingTimeout = 1.5 });
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
            Gives(made, Greeting31 + Null + Filler);
            made.CheckTime(2.9);
            ClientUnit.Equal(Ending.None, made.Ending);
            ClientUnit.Holds(!made.Established && !made.HasRoom && !made.Send(new byte[1], 1));
            made.CheckTime(3.1);
            ClientUnit.Equal(Ending.Foreign, made.Ending);
        }

        public void HowAConnectionIsClosed()
        {
            ZmtpConnection made = new ZmtpConnection(new ZmtpSettings(), 0.0);
            made.NoteClosed();
            ClientUnit.Equal(Ending.Foreign, made.Ending);
            made = Connected();
            Gives(made, "00 01 'a' 04 0b 05'ERROR' 04'over' 00 01 'b'");
            made.NoteClosed();
            ClientUnit.Equal(Ending.Gone, made.Ending);
            Reads(made, "'a'"); // received messages are still read, up to an error
            Reads(made);
            made = Connected();
            Gives(made, "04 0b 05'ERROR' 04'over'");
            Reads(made);
            ClientUnit.Equal(Ending.Gone, made.Ending);
            ClientUnit.Holds(made.Problem.Contains("over"));
        }

        public void MessagesAreTakenUpToALimit()
        {
            ZmtpConnection made = Connected();
            for (int i = 0; i < 16; i++)
            {
                ClientUnit.Holds(made.HasRoom && made.Send(new byte[11], 10));
            }
            ClientUnit.Holds(!made.HasRoom && !made.Send(new byte[11], 10));
            made.Output.MarkSent(11);
            ClientUnit.Holds(!made.HasRoom);
            made.Output.MarkSent(1);
            ClientUnit.Holds(made.HasRoom && made.Send(new byte[11], 10));
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
                    ClientUnit.Holds(socket.MaxWait > 0.0); // a greeting in two parts: nothing to do
                    peer.Send(Bytes(Filler + RouterReady + "00 03 'abc' 00 01 'd'"));
                    Until(() => Works(socket) && socket.HasRoom && socket.MaxWait == 0.0);
                    Until(() => socket.Receive(_into) == 3);
                    ClientUnit.Holds(socket.MaxWait == 0.0 || socket.Receive(_into) == 1);
                    Until(() => socket.Receive(_into) < 0);
                    ClientUnit.Holds(socket.MaxWait > 0.0);
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

        private static ZmtpConnection Connected(ZmtpSettings settings = null)
        {
            ZmtpConnection made = new ZmtpConnection(settings ?? new ZmtpSettings(), 0.0);
            Gives(made, Greeting31 + Null + Filler + RouterReady);
            ClientUnit.Holds(made.Established);
            made.Output.MarkSent(made.Output.Count);
            return made;
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
