using System;
using System.IO;
using UnityEngine;

namespace Pacinian.Haptics.Editing
{
    /// <summary>libzmq, which this package does not contain: it is copied into the project, so that builds have it, too.</summary>
    internal static class NativeLibrary
    {
        private static readonly string[] Usual =
        {
            "/usr/lib/x86_64-linux-gnu/libzmq.so.5", "/usr/lib/aarch64-linux-gnu/libzmq.so.5", "/usr/lib64/libzmq.so.5",
            "/usr/lib/libzmq.so.5", "/opt/homebrew/lib/libzmq.5.dylib", "/usr/local/lib/libzmq.5.dylib",
        };

        /// <summary>What to do where it is missing.</summary>
        public const string Advice =
            "Games need the library libzmq, 4.3 or newer. Linux: install libzmq5 (Debian) or zeromq. macOS: `brew install "
            + "zeromq`. Windows: `vcpkg install zeromq`, then choose its libzmq*.dll here. A copy is put into Assets/Plugins/Pacinian.";

        /// <summary>Where it is in the project.</summary>
        public static string Place
        {
            get { return Path.Combine(Path.Combine(Path.Combine(Application.dataPath, "Plugins"), "Pacinian"), Name); }
        }

        /// <summary>Whether the project has it.</summary>
        public static bool There
        {
            get { return File.Exists(Place); }
        }

        private static string Name
        {
            get
            {
                return Executable.Windows ? "libzmq.dll" : Directory.Exists("/System/Library") ? "libzmq.dylib" : "libzmq.so";
            }
        }

        /// <summary>One that this system has; "" if it has none in the usual places.</summary>
        public static string Find()
        {
            return Array.Find(Usual, File.Exists) ?? "";
        }

        /// <summary>Copies one into the project, under the name by which it is looked for; "", or why that cannot be.</summary>
        public static string Install(string path)
        {
            try
            {
                Directory.CreateDirectory(Path.GetDirectoryName(Place));
                File.Copy(path, Place, true);
                return "";
            }
            catch (Exception error) when (error is IOException || error is UnauthorizedAccessException || error is ArgumentException)
            {
                return path + ": cannot be copied: " + error.Message;
            }
        }
    }
}
