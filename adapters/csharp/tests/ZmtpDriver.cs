using System;
using System.Collections.Concurrent;
using System.Globalization;
using System.Threading;
using Pacinian.Zmtp;

namespace Pacinian.Tests
{
    /// <summary>
    /// A socket that executes commands from standard input, one per line, and prints events as lines of JSON.
    /// Arguments: kind, address, password ("" for NULL), time between heartbeats [s], their timeout [s] and that of
    /// connecting and of the handshake [s], `again` to reconnect. A Sub starts to connect when it gets its topic.
    /// </summary>
    internal sealed class ZmtpDriver
    {
        private readonly ConcurrentQueue<string> _lines = new ConcurrentQueue<string>();
        private readonly AutoResetEvent _wake = new AutoResetEvent(false);
        private readonly byte[] _into = new byte[1 << 20];
        private readonly ZmtpSettings _settings;
        private readonly string[] _arguments;
        private ZmtpSocket _socket;
        private bool _ends, _ended;

        private ZmtpDriver(string[] arguments)
        {
            bool plain = arguments[2].Length > 0;
            _arguments = arguments;
            _settings = new ZmtpSettings
            {
                Kind = (SocketKind)Enum.Parse(typeof(SocketKind), arguments[0]),
                User = plain ? "pacinian" : null,
                Password = plain ? arguments[2] : null,
                PingInterval = double.Parse(arguments[3], CultureInfo.InvariantCulture),
                PingTimeout = double.Parse(arguments[4], CultureInfo.InvariantCulture),
                ConnectTimeout = double.Parse(arguments[5], CultureInfo.InvariantCulture),
                HandshakeTimeout = double.Parse(arguments[5], CultureInfo.InvariantCulture),
            };
            if (_settings.Kind == SocketKind.Dealer)
            {
                Open();
            }
        }

        private static int Main(string[] arguments)
        {
            new ZmtpDriver(arguments).Run();
            return 0;
        }

        private void Run()
        {
            new Thread(Read) { IsBackground = true }.Start();
            while (!_ends)
            {
                if (_socket == null)
                {
                    _wake.WaitOne();
                }
                else
                {
                    Step();
                }
                string line;
                while (!_ends && _lines.TryDequeue(out line))
                {
                    Do(line.Split(' '));
                }
            }
        }

        private void Open()
        {
            _socket = new ZmtpSocket(_settings, Endpoint.Read(_arguments[1]), _arguments[6] == "again", _wake, SteadyClock.Now);
        }

        private void Step()
        {
            int count;
            while ((count = _socket.Receive(_into)) >= 0)
            {
                long sum = 0;
                for (int i = 0; i < count; i++)
                {
                    sum = (sum * 31 + _into[i]) % 1000003;
                }
                ClientJson.Say("received", count, "sum", sum, "hex", BitConverter.ToString(_into, 0, Math.Min(count, 40)).Replace("-", ""));
            }
            if (_socket.Ended != Ending.None && !_ended)
            {
                _ended = true;
                ClientJson.Say("ended", _socket.Ended, "problem", _socket.Problem);
            }
            _socket.Watch();
            _wake.WaitOne((int)Math.Ceiling(1e3 * Math.Min(0.05, _socket.MaxWait)));
            _socket.Work();
        }

        private void Do(string[] words)
        {
            bool done = true;
            switch (words[0])
            {
                case "send": done = _socket.Send(System.Text.Encoding.ASCII.GetBytes(words[1]), words[1].Length); break;
                case "large": done = _socket.Send(Pattern(int.Parse(words[1])), int.Parse(words[1])); break;
                case "subscribe": _settings.Topics.Add(System.Text.Encoding.ASCII.GetBytes(words[1])); Open(); break;
                case "close": _socket.Close(); break;
                case "room": done = _socket.HasRoom; break;
                case "end": _socket?.Close(); _ends = true; break;
                default: throw new ArgumentException(words[0]);
            }
            ClientJson.Say("did", words[0], "done", done);
        }

        private static byte[] Pattern(int count)
        {
            byte[] made = new byte[count];
            for (int i = 0; i < count; i++)
            {
                made[i] = (byte)(i * 7);
            }
            return made;
        }

        private void Read()
        {
            string line;
            while ((line = Console.In.ReadLine()) != null)
            {
                _lines.Enqueue(line);
                _wake.Set();
            }
            _lines.Enqueue("end");
            _wake.Set();
        }
    }
}
