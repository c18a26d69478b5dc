using System;
using System.Collections.Generic;
using System.IO;

namespace Pacinian
{
    /// <summary>Finds the folder in which the server writes its connection file: the user's runtime folder.</summary>
    internal static class RuntimeFolder
    {
        private const string FolderName = "pacinian";
        private const string FileName = "connection.json";

        /// <summary>Returns the path of the existing connection file, or else the first possible path.</summary>
        public static string File()
        {
            string first = null;
            foreach (string folder in Folders())
            {
                string path = Path.Combine(folder, FileName);
                first = first ?? path;
                if (System.IO.File.Exists(path))
                {
                    return path;
                }
            }
            return first;
        }

        private static IEnumerable<string> Folders()
        {
            if (Environment.OSVersion.Platform == PlatformID.Win32NT)
            {
                string local = Environment.GetFolderPath(Environment.SpecialFolder.LocalApplicationData);
                yield return Path.Combine(Path.Combine(Path.Combine(local, "Temp"), FolderName), FolderName);
                yield break;
            }
            string given = Environment.GetEnvironmentVariable("XDG_RUNTIME_DIR");
            if (!string.IsNullOrEmpty(given) && given[0] == '/')
            {
                yield return Path.Combine(given, FolderName);
            }
            string home = Environment.GetEnvironmentVariable("HOME");
            if (!string.IsNullOrEmpty(home) && Directory.Exists("/System/Library")) // macOS
            {
                yield return Path.Combine(home, "Library/Caches/TemporaryItems/" + FolderName);
                yield break;
            }
            uint user = Unix.User();
            yield return "/run/user/" + user + "/" + FolderName;
            yield return Path.Combine(Path.GetTempPath(), "runtime-" + user + "/" + FolderName);
        }
    }
}
