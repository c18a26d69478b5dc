using System;
using System.IO;
using UnityEngine;

namespace Pacinian.Haptics
{
    /// <summary>The server that this program has started, if any: one for all scenes. It ends with the program at the latest.</summary>
    internal static class StartedServer
    {
        private static ServerProcess s_process;

        /// <summary>Finds the program in the editor if the project has none; returns "" if there is none.</summary>
        public static Func<string> FindElsewhere { get; set; } = () => "";

        /// <summary>Why the server does not run; "" if it does, if none was started, or if another one is connected.</summary>
        public static string Problem
        {
            get { return s_process == null ? "" : s_process.Problem; }
        }

        /// <summary>The program to start: the one in StreamingAssets, otherwise the one in the project's settings.</summary>
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

        /// <summary>Starts the server, unless it runs.</summary>
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

        /// <summary>Restarts the server if it has ended and no other is connected; called each frame.</summary>
        public static void Tick(bool connected)
        {
            s_process?.Tick(connected);
        }

        /// <summary>Stops the server.</summary>
        public static void Stop()
        {
            s_process?.Dispose();
            s_process = null;
        }
    }
}
