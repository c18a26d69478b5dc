using System;
using System.Diagnostics;
using System.IO;
using System.Text;
using Pacinian.Wire;

namespace Pacinian
{
    /// <summary>Reads a connection file; null, and what is wrong and what to do, if that cannot be. path: "": where it is found.</summary>
    internal delegate ConnectionFile ConnectionReader(string path, out string problem);

    /// <summary>The connection file: how a program finds the server, and shows that it may connect.</summary>
    public sealed class ConnectionFile
    {
        /// <summary>The environment variable that says where the file is.</summary>
        public const string Variable = "PACINIAN_CONNECTION";

        private const string Advice = "is `pacinian serve` running, or still starting?";
        private const int MaxBytes = 1 << 16; // of the file

        /// <summary>Addresses of the three sockets.</summary>
        public string Control = "", Command = "", State = "";

        /// <summary>The secret of a server on this machine.</summary>
        public string Token = "";

        /// <summary>CURVE keys of a server elsewhere, and our own pair of them (Z85).</summary>
        public string ServerKey = "", PublicKey = "", SecretKey = "";

        /// <summary>The server's process; 0 for one on another machine.</summary>
        public long Pid;

        /// <summary>The file that is given, or as the environment says, or where the server writes it.</summary>
        public static string FindPath(string path)
        {
            if (!string.IsNullOrEmpty(path))
            {
                return path;
            }
            string given = Environment.GetEnvironmentVariable(Variable);
            return string.IsNullOrEmpty(given) ? RuntimeFolder.File() : given;
        }

        /// <summary>Whether that is the content of a connection file, and not its path.</summary>
        public static bool IsText(string path)
        {
            return path != null && path.StartsWith("{", StringComparison.Ordinal);
        }

        /// <summary>
        /// Reads the file of a running server, or its content, whose server may be on another machine; null, and what is wrong and
        /// what to do, if that cannot be.
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

        /// <summary>Where a socket is.</summary>
        public string AddressOf(Channel channel)
        {
            return channel == Channel.Control ? Control : channel == Channel.Command ? Command : State;
        }

        /// <summary>Without secrets, for logs.</summary>
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
            catch (Exception) // not told, of another user's or on a system that tells nothing
            {
                return true;
            }
        }
    }
}
