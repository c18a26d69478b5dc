using System;
using System.IO;
using UnityEngine;

namespace Pacinian.Haptics.Editing
{
    /// <summary>
    /// Copies libzmq into the project, so that builds contain it. Only games that connect to a server on another
    /// machine need it (for CURVE keys), and this package does not contain it.
    /// </summary>
    internal static class NativeLibrary
    {
        private static readonly string[] Usual =
        {
            "/usr/lib/x86_64-linux-gnu/libzmq.so.5", "/usr/lib/aarch64-linux-gnu/libzmq.so.5", "/usr/lib64/libzmq.so.5",
            "/usr/lib/libzmq.so.5", "/opt/homebrew/lib/libzmq.5.dylib", "/usr/local/lib/libzmq.5.dylib",
        };

        // Places of libzmq in pyzmq's wheels on Linux and macOS. On Windows it is inside another library.
        private static readonly string[] Wheels = { "pyzmq.libs", "zmq/.dylibs" };

        /// <summary>What to do if the library is missing.</summary>
        public const string Advice =
            "Games that connect to a server on another machine, with CURVE keys, need the library libzmq, 4.3 or newer. On Linux "
            + "and macOS, use that of the program's Python, or install libzmq5 (Debian) or zeromq (Homebrew). On Windows, run "
            + "`vcpkg install zeromq`, then choose its libzmq*.dll here. A copy is put into Assets/Plugins/Pacinian.";

        /// <summary>The library's path in the project.</summary>
        public static string Place
        {
            get { return Path.Combine(Path.Combine(Path.Combine(Application.dataPath, "Plugins"), "Pacinian"), Name); }
        }

        /// <summary>Whether the project has the library.</summary>
        public static bool There
        {
            get { return File.Exists(Place); }
        }

        private static string Name
        {
            get
            {
                return ServerExecutable.Windows ? "libzmq.dll" : Directory.Exists("/System/Library") ? "libzmq.dylib" : "libzmq.so";
            }
        }

        /// <summary>
        /// Returns the libzmq of the server's Python, or of this system; "" if neither has one. program: path of
        /// `pacinian`, or "".
        /// </summary>
        public static string Find(string program)
        {
            string wheel = program.Length == 0 ? "" : FindInEnvironment(program);
            return wheel.Length > 0 ? wheel : Array.Find(Usual, File.Exists) ?? "";
        }

        /// <summary>
        /// Copies a library into the project, under the name by which it is loaded. Returns "", or the reason for a
        /// failure.
        /// </summary>
        public static string Install(string path)
        {
            return Install(path, Place);
        }

        /// <summary>
        /// Copies a library, and the libraries beside it that it needs, to a place. Returns "", or the reason for a
        /// failure.
        /// </summary>
        internal static string Install(string path, string place)
        {
            try
            {
                string folder = Path.GetDirectoryName(place);
                Directory.CreateDirectory(folder);
                string[] needed = IsOfWheel(path) ? Directory.GetFiles(Path.GetDirectoryName(path), "libsodium*") : new string[0];
                foreach (string beside in needed)
                {
                    File.Copy(beside, Path.Combine(folder, Path.GetFileName(beside)), true);
                }
                File.Copy(path, place, true);
                return "";
            }
            catch (Exception error) when (error is IOException || error is UnauthorizedAccessException || error is ArgumentException)
            {
                return path + ": cannot be copied: " + error.Message;
            }
        }

        private static bool IsOfWheel(string path)
        {
            string folder = Path.GetFileName(Path.GetDirectoryName(path));
            return Array.Exists(Wheels, each => Path.GetFileName(each) == folder);
        }

        private static string FindInEnvironment(string program)
        {
            try
            {
                string root = Path.GetDirectoryName(Path.GetDirectoryName(Interpreter(program)));
                foreach (string version in Directory.GetDirectories(Path.Combine(root, "lib"), "python3*"))
                {
                    foreach (string wheel in Wheels)
                    {
                        string folder = Path.Combine(Path.Combine(version, "site-packages"), wheel);
                        string[] files = Directory.Exists(folder) ? Directory.GetFiles(folder, "libzmq*") : new string[0];
                        if (files.Length > 0)
                        {
                            return files[0];
                        }
                    }
                }
            }
            catch (Exception error) when (error is IOException || error is UnauthorizedAccessException || error is ArgumentException)
            {
                return ""; // another kind of installation
            }
            return "";
        }

        /// <summary>Returns the Python that runs a program, from the program's first line. Follows links.</summary>
        private static string Interpreter(string program)
        {
            char[] start = new char[512];
            int count;
            using (StreamReader reader = new StreamReader(program))
            {
                count = reader.ReadBlock(start, 0, start.Length);
            }
            string line = new string(start, 0, count).Split('\n')[0].Trim();
            return line.StartsWith("#!/", StringComparison.Ordinal) && line.Contains("python") ? line.Substring(2) : program;
        }
    }
}
