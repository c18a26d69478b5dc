using System;
using System.Diagnostics;
using System.IO;
using System.Text;
using Pacinian.Wire;

namespace Pacinian
{
    /// <summary>
    /// Reads a connection file. Returns null, what is wrong and what to do on failure. path: "" searches for the file.
    /// </summary>
    internal delegate ConnectionFile ConnectionReader(string path, out string problem);

    /// <summary>The connection file: it tells a client where the server is, and lets it authenticate.</summary>
    public sealed class ConnectionFile
    {
        /// <summary>The environment variable with the path of the file.</summary>
        public const string Variable = "PACINIAN_CONNECTION";

        private const string Advice = "is `pacinian serve` running, or still starting?";
        private const int MaxBytes = 1 << 16; // of the file

        /// <summary>The addresses of the three sockets.</summary>
        public string Control = "", Command = "", State = "";

        /// <summary>Where a server on this machine receives an emergency stop without a connection; "" if nowhere.</summary>
        public string StopAddress = "";

        /// <summary>The secret of a server on this machine.</summary>
        public string Token = "";

        /// <summary>CURVE keys: of a server on another machine, and the client's own pair (Z85).</summary>
        public string ServerKey = "", PublicKey = "", SecretKey = "";

        /// <summary>The process ID of the server; 0 if it is on another machine.</summary>
        public long Pid;

        /// <summary>
        /// Returns the given path, otherwise that in the environment variable, otherwise the place where the server
        /// writes the file.
        /// </summary>
        public static string FindPath(string path)
        {
            if (!string.IsNullOrEmpty(path))
            {
                return path;
            }
            string given = Environment.GetEnvironmentVariable(Variable);
            return string.IsNullOrEmpty(given) ? RuntimeFolder.File() : given;
        }

        /// <summary>Returns whether a string is the content of a connection file instead of a path.</summary>
        public static bool IsText(string path)
        {
            return path != null && path.StartsWith("{", StringComparison.Ordinal);
        }

        /// <summary>
        /// Reads the file of a running server, or the content of such a file, whose server may be on another machine.
        /// Returns null, what is wrong and what to do on failure.
        /// </summary>
        public static ConnectionFile Read(string path, out string problem)
        {
            if (IsText(path))
            {
                ConnectionFile told = Parse(path, out problem);
                problem = problem.Length > 0 ? "the text of the connection " + problem : "";
                return told;
            }
            path = FindPath(path);
            try
            {
                problem = "";
                string text;
                FileShare shared = FileShare.ReadWrite | FileShare.Delete;
                using (FileStream file = new FileStream(path, FileMode.Open, FileAccess.Read, shared))
                {
                    byte[] data = new byte[Math.Min(file.Length, MaxBytes)];
                    int count = file.Read(data, 0, data.Length);
                    text = Encoding.UTF8.GetString(data, 0, count);
                }
                problem = Unix.Danger(path);
                ConnectionFile made = problem.Length > 0 ? null : Parse(text, out problem);
                if (made != null && made.Pid != 0 && !Unix.IsAndroid && !Runs(made.Pid))
                {
                    problem = "the server that wrote it (process " + made.Pid + ") has gone; " + Advice;
                }
                problem = problem.Length > 0 ? path + ": " + problem : "";
                return problem.Length > 0 ? null : made;
            }
            catch (Exception error) when (error is FileNotFoundException || error is DirectoryNotFoundException)
            {
                problem = path + ": no connection file; " + Advice;
            }
            catch (Exception error) when (error is IOException || error is UnauthorizedAccessException
                || error is ArgumentException || error is NotSupportedException)
            {
                problem = path + ": cannot be read: " + error.Message;
            }
            return null;
        }

        /// <summary>Returns the address of a socket.</summary>
        public string AddressOf(Channel channel)
        {
            return channel == Channel.Control ? Control : channel == Channel.Command ? Command : State;
        }

        /// <summary>Returns a text without secrets, for logs.</summary>
        public override string ToString()
        {
            return "Connection(" + Pid + ", " + Control + ")";
        }

        private static ConnectionFile Parse(string text, out string problem)
        {
            FlatJson file = FlatJson.Parse(text);
            problem = "is no connection file";
            if (file == null || file.Text("format", "") != "pacinian connection")
            {
                return null;
            }
            if (file.Number("version", 0) != 1)
            {
                problem = "is a connection file of another version: update the older of client and server";
                return null;
            }
            problem = "";
            return new ConnectionFile
            {
                Pid = file.Number("pid", 0),
                Control = file.Text("control", ""),
                Command = file.Text("command", ""),
                State = file.Text("state", ""),
                StopAddress = file.Text("stop", ""),
                Token = file.Text("token", ""),
                ServerKey = file.Text("server_key", ""),
                PublicKey = file.Text("public_key", ""),
                SecretKey = file.Text("secret_key", ""),
            };
        }

        private static bool Runs(long pid)
        {
            try
            {
                using (Process found = Process.GetProcessById((int)pid))
                {
                    return !found.HasExited;
                }
            }
            catch (ArgumentException)
            {
                return false;
            }
            catch (Exception) // another user's process, or a system that reports nothing
            {
                return true;
            }
        }
    }
}
