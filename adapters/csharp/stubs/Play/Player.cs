using System;
using System.Collections.Concurrent;
using System.Collections.Generic;
using System.Globalization;
using System.Reflection;
using System.Threading;
using Pacinian.Haptics;
using UnityEditor;
using UnityEngine;

namespace Pacinian.Tests
{
    /// <summary>
    /// Plays a level at 90 Hz. Executes commands from standard input, one per line, and prints events as lines of JSON.
    /// Arguments: the connection file; the lease [s] (0: the server's).
    /// </summary>
    internal sealed class Player
    {
        private const double Frame = 1.0 / 90.0; // [s]

        private readonly ConcurrentQueue<string> _lines = new ConcurrentQueue<string>();
        private readonly string _file;
        private readonly float _lease;
        private Level _level;
        private long _bytes, _frames, _worst;
        private bool _ends, _paused, _waves = true;
        private int _began, _moved, _left, _heard;
        private HapticTouch _touch;
        private HapticStatus _screen;
        private GameObject _shelf;
        private bool _serves;

        private Player(string file, float lease)
        {
            _file = file;
            _lease = lease;
        }

        private static void Main(string[] arguments)
        {
            EditorApplication.Load(Assembly.Load("Pacinian.Haptics.Editor"));
            new Player(arguments[0], Number(arguments[1])).Run();
        }

        private static double Now
        {
            get { return Time.realtimeSinceStartupAsDouble; }
        }

        private void Run()
        {
            new Thread(Read) { IsBackground = true }.Start();
            double due = Now;
            while (!_ends)
            {
                string line;
                while (!_ends && _lines.TryDequeue(out line))
                {
                    Do(line.Split(' '));
                }
                if (_level != null && !_ends)
                {
                    Step();
                }
                due = Math.Max(due + Frame, Now);
                Thread.Sleep((int)Math.Max(0.0, 1e3 * (due - Now)));
            }
        }

        private void Step()
        {
            if (_waves)
            {
                _level.Wave(Now);
            }
            if (_paused)
            {
                EditorApplication.update(); // without a frame
                return;
            }
            long bytes = GC.GetAllocatedBytesForCurrentThread();
            Engine.Frame();
            long made = GC.GetAllocatedBytesForCurrentThread() - bytes;
            _bytes += made;
            _worst = Math.Max(_worst, made);
            _frames++;
        }

        private void Do(string[] words)
        {
            string name = words.Length > 1 ? words[1] : "";
            bool done = true;
            switch (words[0])
            {
                case "play": Play(); break;
                case "again": _level.Server.ArmAgainAfterLoss = true; break;
                case "quit": Engine.Quit(); _level = null; break;
                case "exit": EditorApplication.Raise(PlayModeStateChange.ExitingPlayMode); break;
                case "reload": AssemblyReloadEvents.Raise(); break;
                case "disable": _level.Server.enabled = false; break;
                case "enable": _level.Server.enabled = true; break;
                case "connect": _level.Server.Connect(); break;
                case "disconnect": _level.Server.Disconnect(); break;
                case "reconnect": _level.Server.Reconnect(); break;
                case "arm": done = _level.Server.Arm(); break;
                case "disarm": done = _level.Server.Disarm(); break;
                case "stop": _level.Server.EmergencyStop(); break;
                case "reset": done = _level.Server.ResetOutput(); break;
                case "solver": _level.Server.Solver = name; break;
                case "intensity": _level.Server.Intensity = Number(name); break;
                case "wave": _waves = name == "on"; _level.Wave(0.0); break;
                case "ball": _level.Ball.enabled = name == "on"; break;
                case "shelf": Shelf(name == "on"); break;
                case "serve": Serve(words); break;
                case "point": _level.Point.Play(); break;
                case "both": _level.Point.Play(); _level.Ball.RadiationPressure = Number(name); break;
                case "strength": _level.Ball.RadiationPressure = Number(name); break;
                case "hum": _level.Hum.Frequency = Number(name); break;
                case "hand": _level.Hand.GetComponent<HapticHand>().Source = name == "on" ? HapticHandSource.Open : HapticHandSource.Tracker; break;
                case "mouse": Mouse(words); break;
                case "hands": _level.Hand.GetComponent<HapticHand>().enabled = name == "on"; break;
                case "freeze": Freeze(); break;
                case "pause": _paused = name == "on"; EditorApplication.Pause(_paused); break;
                case "gizmos": Gizmos.Spheres.Clear(); _level.View.SendMessage("OnDrawGizmos"); break;
                case "warm": _bytes = _frames = _worst = 0; break;
                case "status": Tell(); return;
                case "end": _ends = true; break;
                default: throw new ArgumentException(words[0]);
            }
            ClientJson.Say("did", words[0], "done", done);
        }

        /// <summary>Adds a box below the ball to its colliders, or removes it.</summary>
        private void Shelf(bool there)
        {
            _shelf = _shelf ?? new GameObject("shelf", typeof(BoxCollider));
            if (_shelf.transform.parent == null)
            {
                _shelf.transform.SetParent(_level.Ball.transform, false);
            }
            _shelf.transform.localPosition = new Vector3(0f, -1f, 0f);
            _shelf.SetActive(there);
        }

        /// <summary>Makes the next level start a server: its program, and more arguments.</summary>
        private void Serve(string[] words)
        {
            _serves = true;
            PacinianSettings settings = ScriptableObject.CreateInstance<PacinianSettings>();
            settings.ServerCommand = words[1];
            settings.ServerArguments = new List<string>(words).GetRange(2, words.Length - 2).ToArray();
            Resources.Assets["PacinianSettings"] = settings;
        }

        /// <summary>Moves the mouse: right and up from the window's lower left [pixels], and 1 if its button is down.</summary>
        private void Mouse(string[] words)
        {
            _level.Hand.GetComponent<HapticHand>().Source = HapticHandSource.Mouse;
            Input.Given = new Vector3(Number(words[1]), Number(words[2]), 0f);
            Input.Held = words[3] == "1";
        }

        /// <summary>Blocks the game's thread until a command arrives.</summary>
        private void Freeze()
        {
            while (_lines.IsEmpty)
            {
                Thread.Sleep(1);
            }
        }

        private void Play()
        {
            Engine.Play(typeof(HapticServer).Assembly);
            _level = new Level(_file, _lease);
            _level.Server.StartServer = _serves;
            _level.Server.Connected += () => Event("connected", "");
            _level.Server.Lost += why => Event("lost", why);
            _level.Server.Ended += why => Event("ended", why.Code);
            _level.Server.StoodStill += still => Event("stood still", still.ToString());
            _level.Server.TouchBegan += touch => { _began++; _touch = touch; };
            _level.Server.TouchMoved += touch => { _moved++; _touch = touch; };
            _level.Server.TouchEnded += touch => _left++;
            _level.Ball.TouchBegan += touch => _heard++;
            _level.Ball.TouchEnded += touch => _heard--;
            _screen = _level.Array.AddComponent<HapticStatus>();
            _level.Server.Refused += why => Event("refused", why.ToString());
        }

        private void Tell()
        {
            HapticServer server = _level == null ? null : _level.Server;
            Wire.State state = server == null || server.Client == null ? null : server.Client.State;
            ClientJson.Say(
                "status", server == null ? "" : server.Status.ToString(), "problem", server == null ? "" : server.Problem,
                "armed", server != null && server.Armed, "why", server == null ? "" : server.Silence,
                "cause", server == null ? "" : server.SilenceCause, "screen", _screen == null ? "" : _screen.Text,
                "began", _began, "moved", _moved, "left", _left, "heard", _heard, "hand", _touch.Hand ?? "",
                "pressed", _touch.Strength, "beside", _level == null || _began == 0 ? 0.0
                    : (_touch.Position - _level.Ball.transform.position).magnitude,
                "bytes", _frames == 0 ? 0.0 : (double)_bytes / _frames, "worst", _worst, "frames", _frames,
                "output", state == null ? "" : state.Output.ToString().ToLowerInvariant(),
                "solver", state == null ? "" : state.Solver, "intensity", state == null ? -1.0 : state.Intensity,
                "objects", state == null ? -1 : state.Objects.Count, "hands", state == null ? -1 : state.Hands.Numbers / 78,
                "emitted", _level == null ? 0.0 : _level.Ball.Emitted, "force", _level != null && _level.Ball.RegionFelt.Known ? _level.Ball.RegionFelt.Force : 0.0,
                "pointed", _level != null && _level.Point.RegionFelt.Known, "playing", _level != null && _level.Point.Playing,
                "wrong", _level == null ? "" : _level.Ball.Problem, "flash", _level == null ? 0.0 : _level.Point.Emitted, "drawn", Gizmos.Spheres.Count,
                "apart", _level == null ? 0.0 : Apart(), "said", string.Join("|", Debug.Said.ToArray()),
                "behaviours", Engine.Count, "current", HapticServer.Current != null);
        }

        /// <summary>Returns the largest distance of a drawn sphere from the ball's surface [m].</summary>
        private double Apart()
        {
            double farthest = 0.0;
            foreach (Vector3 place in Gizmos.Spheres)
            {
                double far = (place - _level.Ball.transform.position).magnitude - 0.03;
                farthest = Math.Max(farthest, Math.Abs(far));
            }
            return farthest;
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

        private static void Event(string what, string why)
        {
            ClientJson.Say("event", what, "code", why);
        }

        private static float Number(string word)
        {
            return float.Parse(word, CultureInfo.InvariantCulture);
        }
    }
}
