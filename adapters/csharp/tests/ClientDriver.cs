using System;
using System.Collections.Concurrent;
using System.Collections.Generic;
using System.Globalization;
using System.Threading;
using Pacinian.Wire;

namespace Pacinian.Tests
{
    /// <summary>
    /// A game that executes commands from standard input, one per line, and prints events as lines of JSON. Arguments:
    /// connection file (-: the default), lease [s] (0: the server's), time to live of a command [s], timeout of an
    /// answer [s].
    /// </summary>
    internal sealed class ClientDriver
    {
        private const double Frame = 1.0 / 90.0; // [s]

        private readonly ConcurrentQueue<string> _lines = new ConcurrentQueue<string>();
        private HapticClient _client;
        private readonly List<HandFrame> _hands = new List<HandFrame>();
        private readonly HandFrame _hand = new HandFrame();
        private readonly Func<double> _steady;
        private readonly ManualResetEvent _held = new ManualResetEvent(true);
        private readonly AutoResetEvent _stands = new AutoResetEvent(false);
        private bool _ends, _still, _waves;
        private HandTouch _moved;

        private ClientDriver(Options options)
        {
            _steady = options.Clock;
            options.Clock = Clock;
            _client = new HapticClient(options);
            _client.Connected += () => Event("connected", "", "", "");
            _client.Lost += why => Event("lost", "", why, "");
            _client.Ended += why => Event("ended", why.Code, why.Message, why.Advice);
            _client.TouchBegan += touch => Event("touch", touch);
            _client.TouchMoved += touch => _moved = touch;
            _client.TouchEnded += touch => Event("left", touch);
            _client.StoodStill += still => ClientJson.Say("event", "stood still", "seconds", still.Seconds, "whole", still.Whole, "text", still.ToString());
            _client.Refused += why => Event("refused", why.Code, why.Message, why.Advice, why.Path);
        }

        private static int Main(string[] arguments)
        {
            new ClientDriver(new Options
            {
                ConnectionPath = arguments[0] == "-" ? "" : arguments[0],
                Lease = Number(arguments[1]),
                Life = Number(arguments[2]),
                Timeout = Number(arguments[3]),
                Name = "driver",
            }).Run();
            return 0;
        }

        private void Run()
        {
            new Thread(Read) { IsBackground = true }.Start();
            double due = _client.Now;
            while (!_ends)
            {
                string line;
                while (!_ends && _lines.TryDequeue(out line))
                {
                    Do(line.Split(' '));
                }
                if (!_still && !_ends)
                {
                    Step();
                }
                due = Math.Max(due + Frame, _client.Now);
                Thread.Sleep((int)Math.Max(0.0, 1e3 * (due - _client.Now)));
            }
        }

        private void Step()
        {
            _client.Tick();
            if (_waves)
            {
                double now = _client.Now;
                _hands.Clear();
                Vec3 palm = new Vec3(0.02 * Math.Sin(2.0 * Math.PI * 0.5 * now), 0.0, 0.2);
                OpenHand.Write(_hand, HandFrameSide.Right, new Rigid(palm, Quat.Identity));
                _hands.Add(_hand);
                _client.Hands(_hands);
            }
        }

        private void Do(string[] words)
        {
            string name = words.Length > 1 ? words[1] : "";
            bool done = true;
            switch (words[0])
            {
                case "start": _client.Start(); break;
                case "put": done = _client.Put(name, Point(words)); break;
                case "ball": done = _client.Put(name, Ball(Number(words[2]), Number(words[3]))); break;
                case "elsewhere": done = Elsewhere(() => _client.Put(name, Point(words))); break;
                case "heavy": done = _client.Put(name, Rain((int)Number(words[2]))); break;
                case "move": done = _client.Move(name, To(words)); break;
                case "remove": done = _client.Remove(name); break;
                case "clear": done = _client.Clear(); break;
                case "envelope": done = _client.Envelope(name, new Sine { Frequency = Number(words[2]) }); break;
                case "quiet": done = _client.Quiet(Zones(words)); break;
                case "wave": _waves = name == "on"; break;
                case "lose": _waves = false; _hands.Clear(); done = _client.Hands(_hands); break;
                case "arm": done = _client.Arm(name == "take", name != "once"); break;
                case "disarm": done = _client.Disarm(); break;
                case "stop": _client.Stop(); break;
                case "reset": done = _client.Reset(); break;
                case "solver": done = _client.Select(new Choice { Name = name }); break;
                case "backend": done = _client.Select(backend: new Choice { Name = name }); break;
                case "intensity": done = _client.Select(intensity: Number(name)); break;
                case "field": done = _client.Field(Points(words), Felt); break;
                case "tick": _still = name == "off"; break;
                case "freeze": Freeze(); break;
                case "hold": _held.Reset(); _stands.WaitOne(); break;
                case "release": _held.Set(); break;
                case "dispose": _client.Dispose(); break;
                case "felt": Tell(name, _client.Felt(name)); return;
                case "status": Tell(); return;
                case "forget": Forget(); break;
                case "end": _ends = true; break;
                default: throw new ArgumentException(words[0]);
            }
            ClientJson.Say("did", words[0], "done", done, "time", _client.Now);
        }

        private void Tell()
        {
            bool seen = _client.State != null;
            State state = _client.State ?? new State();
            Abilities abilities = _client.Capabilities;
            ClientJson.Say(
                "status", _client.Status, "problem", _client.Problem, "armed", _client.Armed, "owner", _client.Owner,
                "lease", _client.Lease, "latency", _client.Latency, "scene", _client.Scene, "server", _client.Server,
                "offset", _client.Offset, "time", _client.Now,
                "solvers", abilities == null ? -1 : abilities.Solvers.Count, "age", seen ? _client.Age(state) : -1.0,
                "output", state.Output.ToString().ToLowerInvariant(), "objects", seen ? state.Objects.Count : -1,
                "solver", state.Solver, "backend", state.Backend, "intensity", state.Intensity,
                "cause", _client.Silence.Cause ?? "", "why", _client.Silence.ToString(),
                "touches", _client.Touches.Count, "touched", _moved.Object ?? "", "strength", _moved.Strength, "height", _moved.Position.Z,
                "points", state.Points.Count / 12, "hands", state.Hands.Count / 312, "sequence", state.Sequence);
        }

        /// <summary>Makes a call on another thread.</summary>
        private static bool Elsewhere(Func<bool> call)
        {
            bool done = false;
            Thread thread = new Thread(() => done = call());
            thread.Start();
            thread.Join();
            return done;
        }

        private static void Tell(string name, RegionFelt felt)
        {
            bool known = felt.Known;
            ClientJson.Say(
                "region", name, "known", known, "force", known ? felt.Force : 0f, "rms", known ? felt.Rms : 0f,
                "holes", known ? felt.Holes : 0f, "spill", known ? felt.Spill : 0f);
        }

        private void Felt(Pressures answer)
        {
            ClientJson.Say("field", answer == null ? -1 : answer.Values.Count / 8, "time", _client.Now);
        }

        /// <summary>Blocks the game's thread until a command arrives.</summary>
        private void Freeze()
        {
            while (_lines.IsEmpty)
            {
                Thread.Sleep(1);
            }
        }

        /// <summary>Returns the time. Blocks the client's own thread between "hold" and "release".</summary>
        private double Clock()
        {
            if (Thread.CurrentThread.Name == "Pacinian" && !_held.WaitOne(0))
            {
                _stands.Set();
                _held.WaitOne();
            }
            return _steady();
        }

        private void Forget()
        {
            _still = true;
            _client = new HapticClient(new Options());
            Thread.Sleep(20);
            GC.Collect();
            GC.WaitForPendingFinalizers();
        }

        private void Read()
        {
            string line;
            while ((line = Console.In.ReadLine()) != null)
            {
                _lines.Enqueue(line);
            }
            _lines.Enqueue("end");
        }

        private void Event(string what, string code, string message, string advice, string path = "")
        {
            ClientJson.Say(
                "event", what, "code", code, "message", message, "advice", advice, "path", path, "time", _client.Now);
        }

        private void Event(string what, HandTouch touch)
        {
            ClientJson.Say("event", what, "object", touch.Object, "hand", touch.Hand, "strength", touch.Strength, "time", _client.Now);
        }

        private static double Number(string word)
        {
            return double.Parse(word, CultureInfo.InvariantCulture);
        }

        private static Vec3 At(string[] words)
        {
            return new Vec3(Number(words[2]), Number(words[3]), Number(words[4]));
        }

        private static Point Point(string[] words)
        {
            return new Point { Position = At(words), RadiationPressure = Number(words[5]) };
        }

        /// <summary>pressure: 0 for none.</summary>
        private static Volume Ball(double radius, double pressure)
        {
            return new Volume { Shape = new Sphere { Radius = radius }, RadiationPressure = pressure == 0.0 ? (double?)null : pressure };
        }

        private static Movement To(string[] words)
        {
            return new Movement(At(words), Quat.Identity);
        }

        private static Bulk Points(string[] words)
        {
            Bulk points = new Bulk();
            points.Add(At(words));
            return points;
        }

        private static List<Zone> Zones(string[] words)
        {
            return new List<Zone> { new Zone { Position = At(words), Pressure = Number(words[5]) } };
        }

        private static Particles Rain(int count)
        {
            Particles rain = new Particles { RadiationPressure = 5.0 };
            for (int i = 0; i < count; i++)
            {
                rain.Positions.Add(new Vec3(0.0, 0.0, 1e-5 * i));
            }
            return rain;
        }
    }
}
