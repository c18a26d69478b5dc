using System;
using System.Collections.Generic;
using System.IO;
using UnityEditor;
using UnityEngine;

namespace Pacinian.Haptics.Editing
{
    /// <summary>Where the program `pacinian` is.</summary>
    internal static class Executable
    {
        private const string Key = "Pacinian.Executable";

        /// <summary>What to do where it is missing.</summary>
        public const string Advice =
            "The program `pacinian` was not found. With Python 3.11 or newer, in a virtual environment: "
            + "`python -m pip install` of a checkout of Pacinian (its README says how). Then choose the program here: it is in "
            + "the environment's folder `bin`, or `Scripts` on Windows. A server that runs already needs none of this.";

        /// <summary>Chosen by the user; "" if none is.</summary>
        public static string Chosen
        {
            get { return EditorPrefs.GetString(Key, ""); }
            set { EditorPrefs.SetString(Key, value); }
        }

        /// <summary>Chosen, in PATH, beside this project, or where installers put it; "" if it is nowhere.</summary>
        public static string Find()
        {
            if (File.Exists(Chosen))
            {
                return Chosen;
            }
            string name = Windows ? "pacinian.exe" : "pacinian";
            foreach (string folder in Folders())
            {
                string path = folder.Length == 0 ? "" : Path.Combine(folder.Trim('"'), name);
                if (path.Length > 0 && File.Exists(path))
                {
                    return path;
                }
            }
            return "";
        }

        internal static bool Windows
        {
            get { return Environment.OSVersion.Platform == PlatformID.Win32NT; }
        }

        /// <summary>Programs that a desktop starts have a shorter PATH than a terminal: the usual places, too.</summary>
        private static IEnumerable<string> Folders()
        {
            foreach (string folder in (Environment.GetEnvironmentVariable("PATH") ?? "").Split(Path.PathSeparator))
            {
                yield return folder;
            }
            string inside = Windows ? "Scripts" : "bin";
            string project = Path.GetDirectoryName(Path.GetFullPath(Application.dataPath)) ?? "";
            string home = Environment.GetFolderPath(Environment.SpecialFolder.UserProfile);
            yield return Path.Combine(Path.Combine(project, ".venv"), inside);
            yield return Path.Combine(Path.Combine(home, ".venv"), inside);
            yield return Path.Combine(Path.Combine(home, ".local"), "bin");
            yield return "/usr/local/bin";
            yield return "/opt/homebrew/bin";
        }
    }
}
