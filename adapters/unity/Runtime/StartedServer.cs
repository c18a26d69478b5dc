using System;
using System.IO;
using UnityEngine;

namespace Pacinian.Haptics
{
    /// <summary>The server that this program has started, if it has: one for all scenes. It ends with the program, at the latest.</summary>
    internal static class StartedServer
    {
        private static ServerProcess s_process;

        /// <summary>Where the editor finds the program, if the project has none; "": nowhere.</summary>
        public static Func<string> FindElsewhere { get; set; } = () => "";

        /// <summary>Why it does not run; "" if it does, if none was started, or if another one is connected.</summary>
        public static string Problem
        {
            get { return s_process == null ? "" : s_process.Problem; }
        }

        /// <summary>The program that is started: the project's own, or else the one that its settings name.</summary>
        public static string Program
        {
            get
            {
                bool windows = Path.DirectorySeparatorChar == '\\';
                string folder = Path.Combine(Application.streamingAssetsPath, "pacinian");
                string own = Path.Combine(folder, windows ? "pacinian.exe" : "pacinian");
                string named = PacinianSettings.Current.ServerCommand;
                string found = named == "pacinian" ? FindElsewhere() : "";
                return File.Exists(own) ? own : found.Length > 0 ? found : named;
            }
        }

        /// <summary>Starts it, unless one runs.</summary>
        public static void Start(string connection)
        {
            if (s_process == null || !s_process.Running)
            {
                s_process = new ServerProcess(Program, connection, "", string.Join(" ", PacinianSettings.Current.ServerArguments));
            }
            if (!s_process.Start())
            {
                Debug.LogWarning("Pacinian: " + s_process.Problem);
            }
        }

        /// <summary>In each frame: starts it again if it has ended and no other is connected.</summary>
        public static void Tick(bool connected)
        {
            s_process?.Tick(connected);
        }

        /// <summary>Ends it.</summary>
        public static void Stop()
        {
            s_process?.Dispose();
            s_process = null;
        }
    }
}
