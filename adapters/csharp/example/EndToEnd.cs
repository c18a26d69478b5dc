using System;
using System.Collections.Generic;
using System.Globalization;
using System.Threading;
using Pacinian.Wire;

namespace Pacinian.Example
{
    /// <summary>
    /// A complete game: connects, puts a ball, moves a hand at 90 Hz, changes solver and backend, reads back what is
    /// emitted, and prints a line of JSON. Then it plays on until it is killed, and prints a line for each stretch.
    /// Arguments: connection file (-: the default), how long the hand moves before the first line [s].
    /// </summary>
    internal sealed class EndToEnd
    {
        private const double Frame = 1.0 / 90.0; // [s]
        private const double Steady = 0.2, SolverChange = 0.6, BackendChange = 0.8; // when these begin: fractions of the time
        private const double Timeout = 60.0; // [s]
        private const double Height = 0.2; // [m]

        private readonly Figures _handAges = new Figures(), _calls = new Figures();
        private readonly List<HandFrame> _hands = new List<HandFrame>();
        private readonly HandFrame _open = new HandFrame();
        private readonly HapticClient _client;
        private readonly double _seconds;
        private MeteredTransport _transport;
        private string _solver, _backend;
        private long _bytes, _workerBytes, _foci;
        private int _frames, _steady;
        private double _farthest;
        private bool _solverChanged, _backendChanged;

        private EndToEnd(string path, double seconds)
        {
            _seconds = seconds;
            _client = new HapticClient(new Options
            {
                ConnectionPath = path, Name = "end-to-end", Transport = () => _transport = new MeteredTransport(),
            });
            _client.Connected += Begin;
            _client.Lost += Fail;
            _client.Ended += why => Fail(why.ToString());
            _client.Refused += why => Fail(why.ToString());
            _client.StateChanged += Look;
        }

        private long WorkerBytes
        {
            get { return _transport == null ? 0 : _transport.Bytes; }
        }

        private static void Main(string[] arguments)
        {
            string path = arguments.Length > 0 && arguments[0] != "-" ? arguments[0] : "";
            double seconds = arguments.Length > 1 ? double.Parse(arguments[1], CultureInfo.InvariantCulture) : 10.0;
            new EndToEnd(path, seconds).Run();
        }

        private void Run()
        {
            _client.Start();
            Until(() => _client.State != null && _client.State.Output == Output.Sounding);
            double begin = _client.Now;
            while (_client.Now - begin < _seconds)
            {
                Step((_client.Now - begin) / _seconds);
            }
            Until(() => _client.State.Solver == _solver && _client.State.Backend == _backend
                && _client.State.Output == Output.Sounding && _client.State.Points.Count > 0);
            while (true) // until the program is killed
            {
                Console.Out.WriteLine(Report());
                Console.Out.Flush();
                _steady = 0;
                _bytes = _workerBytes = 0;
                begin = _client.Now;
                while (_client.Now - begin < (SolverChange - Steady) * _seconds)
                {
                    Step(Steady);
                }
            }
        }

        private void Begin()
        {
            _client.Put("ball", new Volume
            {
                Shape = new Sphere { Radius = 0.03 },
                Pose = new HapticPose { Position = new Vec3(0.0, 0.01, Height) },
                RadiationPressure = 20.0,
            });
            _client.Arm();
        }

        private void Step(double share)
        {
            bool steady = share >= Steady && share < SolverChange;
            if (share >= SolverChange && !_solverChanged)
            {
                _solverChanged = true;
                _solver = _client.State.Solver == "gs" ? "weighted-gs" : "gs";
                _client.Select(new Choice { Name = _solver });
            }
            if (share >= BackendChange && !_backendChanged)
            {
                _backendChanged = true;
                _backend = Another(_client.State.Backend);
                _client.Select(backend: new Choice { Name = _backend });
            }
            long bytes = GC.GetAllocatedBytesForCurrentThread(), worker = WorkerBytes;
            double begin = _client.Now;
            _client.Tick();
            _hands.Clear();
            Vec3 palm = new Vec3(0.02 * Math.Sin(2.0 * Math.PI * 0.5 * begin), 0.0, Height + 0.02);
            OpenHand.Write(_open, HandFrameSide.Right, new Rigid(palm, Quat.Identity));
            _hands.Add(_open);
            _client.Hands(_hands);
            double end = _client.Now;
            if (steady)
            {
                _steady++;
                _bytes += GC.GetAllocatedBytesForCurrentThread() - bytes;
                _calls.Add(end - begin);
            }
            _frames++;
            Thread.Sleep((int)Math.Max(0.0, 1e3 * (begin + Frame - _client.Now)));
            _workerBytes += steady ? WorkerBytes - worker : 0;
        }

        private void Until(Func<bool> done)
        {
            double end = _client.Now + Timeout;
            while (!done())
            {
                Step(0.0);
                if (_client.Now > end)
                {
                    Fail("nothing came within " + Timeout + " s: " + _client.Problem);
                }
            }
        }

        private string Another(string name)
        {
            Items<Plugin> all = _client.Capabilities.Backends;
            for (int i = 0; i < all.Count; i++)
            {
                if (all[i].Name.StartsWith("probe", StringComparison.Ordinal) && all[i].Name != name)
                {
                    return all[i].Name;
                }
            }
            return name;
        }

        private void Look(State state)
        {
            for (int i = 0; i < state.Inputs.Count / 32; i++)
            {
                double sent = state.Inputs.Real(4 * i + 1), emitted = state.Inputs.Real(4 * i + 3);
                _handAges.Add(emitted - _client.Offset - sent);
            }
            for (int i = 0; i < state.Points.Count / 12; i++)
            {
                _foci++;
                Vec3 off = state.Points.Point(i) - new Vec3(0.0, 0.01, Height);
                _farthest = Math.Max(_farthest, Math.Sqrt(Vec3.Dot(off, off)));
            }
        }

        private string Report()
        {
            RoundTrips roundTrips = _client.RoundTrips;
            State state = _client.State;
            return "{\"frames\":" + _frames + ",\"foci\":" + _foci + ",\"far\":" + Figures.Json(_farthest)
                + ",\"solver\":\"" + state.Solver + "\",\"backend\":\"" + state.Backend + "\""
                + ",\"round_trip_p50\":" + Figures.Json(roundTrips.Median) + ",\"round_trip_p99\":" + Figures.Json(roundTrips.P99)
                + ",\"inputs\":" + _handAges.Count + ",\"hand_p50\":" + Figures.Json(_handAges.Quantile(0.5))
                + ",\"hand_p99\":" + Figures.Json(_handAges.Quantile(0.99))
                + ",\"call_p50\":" + Figures.Json(_calls.Quantile(0.5)) + ",\"call_p99\":" + Figures.Json(_calls.Quantile(0.99))
                + ",\"call_longest\":" + Figures.Json(_calls.Quantile(1.0))
                + ",\"steady\":" + _steady + ",\"bytes_per_frame\":" + Figures.Json((double)_bytes / _steady)
                + ",\"worker_bytes_per_frame\":" + Figures.Json((double)_workerBytes / _steady) + "}";
        }

        private static void Fail(string why)
        {
            Console.Error.WriteLine(why);
            Environment.Exit(1);
        }
    }
}
