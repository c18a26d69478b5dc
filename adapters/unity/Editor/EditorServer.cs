using System;
using System.ComponentModel;
using System.Diagnostics;
using System.Globalization;
using System.IO;
using UnityEditor;

namespace Pacinian.Haptics.Editing
{
    /// <summary>
    /// A server that the editor has started. It keeps running while scripts are reloaded, and logs to a file, so that
    /// no output is lost meanwhile. It ends with the editor.
    /// </summary>
    internal static class EditorServer
    {
        private const string Key = "Pacinian.EditorServer";
        private const int Shown = 8000; // [bytes] at the log's end

        private static Process s_process;

        /// <summary>The log file, in the project's folder Logs, where only the project's users can write.</summary>
        public static string LogFile
        {
            get { return Path.GetFullPath(Path.Combine("Logs", "pacinian-serve.log")); }
        }

        /// <summary>Whether the server runs.</summary>
        public static bool Running
        {
            get
            {
                Process process = Found();
                return process != null && !process.HasExited;
            }
        }

        /// <summary>
        /// Starts the server. Returns "", or the reason for a failure. arguments: of `serve`, none with a space in it.
        /// </summary>
        public static string Start(string executable, string arguments)
        {
            if (Running)
            {
                return "";
            }
            ProcessStartInfo how = new ProcessStartInfo { UseShellExecute = false, CreateNoWindow = true };
            how.FileName = ServerExecutable.Windows ? "cmd.exe" : "/bin/sh";
            how.Arguments = ServerExecutable.Windows
                ? "/d /s /c \"\"%PACINIAN_PROGRAM%\" serve %PACINIAN_ARGUMENTS% > \"%PACINIAN_LOG%\" 2>&1\""
                : "-fc \"exec \\\"$PACINIAN_PROGRAM\\\" serve $PACINIAN_ARGUMENTS >\\\"$PACINIAN_LOG\\\" 2>&1\"";
            how.EnvironmentVariables["PACINIAN_PROGRAM"] = executable;
            how.EnvironmentVariables["PACINIAN_ARGUMENTS"] = arguments;
            how.EnvironmentVariables["PACINIAN_LOG"] = LogFile;
            how.EnvironmentVariables["PYTHONUNBUFFERED"] = "1";
            try
            {
                Directory.CreateDirectory(Path.GetDirectoryName(LogFile));
                s_process = Process.Start(how);
                SessionState.SetString(Key, Mark(s_process));
                return "";
            }
            catch (Exception error) when (error is Win32Exception || error is InvalidOperationException
                || error is IOException || error is UnauthorizedAccessException)
            {
                return executable + ": cannot be started: " + error.Message;
            }
        }

        /// <summary>Asks the server to end; it silences the array first. Does not wait.</summary>
        public static void Stop()
        {
            Process process = Found();
            if (process != null && !process.HasExited)
            {
                string id = process.Id.ToString(CultureInfo.InvariantCulture);
                ProcessStartInfo how = ServerExecutable.Windows
                    ? new ProcessStartInfo("cmd.exe", "/d /s /c \"\"%PACINIAN_PROGRAM%\" stop & taskkill /T /F /PID " + id + "\"")
                    : new ProcessStartInfo("/bin/sh", "-c \"kill -TERM " + id + "\"");
                how.UseShellExecute = false;
                how.CreateNoWindow = true;
                how.EnvironmentVariables["PACINIAN_PROGRAM"] = ServerExecutable.Find();
                Process.Start(how).Dispose();
            }
            SessionState.SetString(Key, "");
        }

        /// <summary>Returns the end of the log.</summary>
        public static string Log()
        {
            try
            {
                using (FileStream file = new FileStream(LogFile, FileMode.Open, FileAccess.Read, FileShare.ReadWrite | FileShare.Delete))
                {
                    file.Seek(-Math.Min(Shown, file.Length), SeekOrigin.End);
                    return new StreamReader(file).ReadToEnd();
                }
            }
            catch (Exception error) when (error is IOException || error is UnauthorizedAccessException)
            {
                return "";
            }
        }

        /// <summary>Returns the process that the editor started, even before a reload of scripts; null if there is none.</summary>
        private static Process Found()
        {
            string mark = SessionState.GetString(Key, "");
            int id;
            if (s_process == null && int.TryParse(mark.Split(' ')[0], out id))
            {
                try
                {
                    Process found = Process.GetProcessById(id);
                    s_process = Mark(found) == mark ? found : null;
                }
                catch (ArgumentException)
                {
                    SessionState.SetString(Key, "");
                }
            }
            return s_process;
        }

        /// <summary>Returns an identifier of a process. Its number alone does not suffice, because the system may reuse it.</summary>
        private static string Mark(Process process)
        {
            string id = process.Id.ToString(CultureInfo.InvariantCulture);
            try
            {
                return id + " " + process.StartTime.Ticks.ToString(CultureInfo.InvariantCulture);
            }
            catch (Exception error) when (error is Win32Exception || error is InvalidOperationException)
            {
                return id + " ended";
            }
        }
    }
}
