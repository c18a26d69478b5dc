using System;
using System.Collections.Generic;
using System.IO;
using UnityEditor;
using UnityEngine;

namespace Pacinian.Haptics.Editing
{
    /// <summary>Finds the program `pacinian`.</summary>
    internal static class ServerExecutable
    {
        private const string Key = "Pacinian.Executable";

        /// <summary>What to do if the program is missing.</summary>
        public const string Advice =
            "The program `pacinian` was not found. Install Pacinian from a checkout with `python -m pip install`, in a virtual "
            + "environment with Python 3.11 or newer (its README says how). Then choose the program here: it is in the "
            + "environment's folder `bin`, or `Scripts` on Windows. If a server runs already, you need none of this.";

        /// <summary>The path that the user has chosen; "" if none.</summary>
        public static string Chosen
        {
            get { return EditorPrefs.GetString(Key, ""); }
            set { EditorPrefs.SetString(Key, value); }
        }

        /// <summary>
        /// Returns the chosen program, or that which `pacinian unity` noted, or one in PATH, beside this project, or where
        /// installers put it; "" if there is none.
        /// </summary>
        public static string Find()
        {
            foreach (string known in new[] { Chosen, Noted() })
            {
                if (File.Exists(known))
                {
                    return known;
                }
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

        private static string Project
        {
            get { return Path.GetDirectoryName(Path.GetFullPath(Application.dataPath)) ?? ""; }
        }

        /// <summary>The file in which `pacinian unity` notes the program of its installation.</summary>
        internal static string Note
        {
            get { return Path.Combine(Path.Combine(Project, "UserSettings"), "PacinianProgram.txt"); }
        }

        private static string Noted()
        {
            try
            {
                return File.Exists(Note) ? File.ReadAllText(Note).Trim() : "";
            }
            catch (Exception error) when (error is IOException || error is UnauthorizedAccessException)
            {
                return "";
            }
        }

        internal static bool Windows
        {
            get { return Environment.OSVersion.Platform == PlatformID.Win32NT; }
        }

        /// <summary>
        /// Lists PATH and the usual folders, because programs started from a desktop have a shorter PATH than a
        /// terminal.
        /// </summary>
        private static IEnumerable<string> Folders()
        {
            foreach (string folder in (Environment.GetEnvironmentVariable("PATH") ?? "").Split(Path.PathSeparator))
            {
                yield return folder;
            }
            string inside = Windows ? "Scripts" : "bin";
            string home = Environment.GetFolderPath(Environment.SpecialFolder.UserProfile);
            yield return Path.Combine(Path.Combine(Project, ".venv"), inside);
            yield return Path.Combine(Path.Combine(home, ".venv"), inside);
            yield return Path.Combine(Path.Combine(home, ".local"), "bin");
            yield return "/usr/local/bin";
            yield return "/opt/homebrew/bin";
        }
    }
}
