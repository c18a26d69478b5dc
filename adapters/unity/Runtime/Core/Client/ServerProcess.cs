using System;
using System.ComponentModel;
using System.Diagnostics;
using System.Globalization;
using System.IO;
using System.Threading;

namespace Pacinian
{
    /// <summary>
    /// The server, if this program is to start it: `pacinian serve`, as installed or as a standalone folder. It ends with this
    /// program, however that ends. If another server has written the connection file, none is started as long as the client
    /// can connect to that one. Belongs to one thread; only Stop waits.
    /// </summary>
    public sealed class ServerProcess : IDisposable
    {
        private const double FirstPause = 2.0, LongestPause = 30.0; // [s] between two starts
        private const double Well = 10.0; // [s] after which the next pause is the first again
        private const int Tail = 2000; // of a log [bytes]
        private const int NotFound = 127, NotFoundByWindows = 9009; // exit codes of a shell
        private const int Killed = 128 + 9; // exit code of a program that was ended by SIGKILL

        private static readonly bool Windows = Path.DirectorySeparatorChar == '\\';

        private readonly string _program, _connection, _log, _arguments;
        private readonly bool _temporaryLog;
        private Process _process;
        private bool _wanted;
        private double _started, _due, _pause = FirstPause;

        /// <summary>
        /// Not started yet. program: its path, or its name if the system finds it. connection: the connection file; "": where
        /// clients look for it. log: a file for what it says; "": one in the folder for temporary files, which Stop deletes.
        /// arguments: more for `serve`, such as the path of a configuration, without spaces inside of one.
        /// </summary>
        public ServerProcess(string program, string connection = "", string log = "", string arguments = "")
        {
            _program = program;
            _connection = connection;
            _temporaryLog = log.Length == 0;
            _log = _temporaryLog ? Path.Combine(Path.GetTempPath(), "pacinian-" + Guid.NewGuid().ToString("N") + ".log") : log;
            _arguments = arguments;
        }

        /// <summary>Why it does not run; "" if it does, or the client is connected to another one.</summary>
        public string Problem { get; private set; } = "";

        /// <summary>Whether it was started here, and has not ended.</summary>
        public bool Running
        {
            get { return _process != null && !_process.HasExited; }
        }

        /// <summary>Starts it, unless another server runs. False if it cannot be started: see Problem.</summary>
        public bool Start()
        {
            if (Running)
            {
                return true;
            }
            if (ConnectionFile.IsText(_connection))
            {
                Problem = "a connection that is given as text is of a server elsewhere: none is started here";
                return false;
            }
            _wanted = true;
            _pause = FirstPause;
            Problem = "";
            if (ConnectionFile.Read(_connection, out string _) == null)
            {
                return Begin(Timing.Now());
            }
            Rest(Timing.Now());
            return true;
        }

        /// <summary>
        /// Once in each of the game's frames: starts it again, after 2 s at first and 30 s at most, if it has ended and the
        /// client is not connected to another one.
        /// </summary>
        public void Tick(bool connected)
        {
            double now = Timing.Now();
            if (!_wanted)
            {
                return;
            }
            if (_process != null && _process.HasExited)
            {
                Bury(now);
            }
            Problem = connected ? "" : Problem;
            if (connected || (_process != null && now > _started + Well))
            {
                _pause = FirstPause;
            }
            if (connected && _process == null)
            {
                Rest(now);
            }
            if (!connected && _process == null && now >= _due)
            {
                Begin(now);
            }
        }

        /// <summary>Ends it, and with it all sound, if it was started here. Takes at most so long [s], and then kills it.</summary>
        public void Stop(double patience = 5.0)
        {
            _wanted = false;
            if (_process != null)
            {
                _process.StandardInput.Close();
                for (double end = Timing.Now() + patience; !_process.HasExited; Thread.Sleep(10))
                {
                    if (Timing.Now() > end)
                    {
                        Kill();
                    }
                }
                Forget();
            }
            DeleteTemporaryLog();
        }

        /// <summary>As Stop.</summary>
        public void Dispose()
        {
            Stop();
        }

        private bool Begin(double now)
        {
            ProcessStartInfo how = new ProcessStartInfo
            {
                UseShellExecute = false, CreateNoWindow = true, RedirectStandardInput = true,
                FileName = Windows ? "cmd.exe" : "/bin/sh",
                Arguments = Windows
                    ? "/d /s /c \"\"%PACINIAN_PROGRAM%\" serve --until-eof %PACINIAN_ARGUMENTS% > \"%PACINIAN_LOG%\" 2>&1\""
                    : "-fc \"exec \\\"$PACINIAN_PROGRAM\\\" serve --until-eof $PACINIAN_ARGUMENTS >\\\"$PACINIAN_LOG\\\" 2>&1\"",
            };
            how.EnvironmentVariables["PACINIAN_PROGRAM"] = _program;
            how.EnvironmentVariables["PACINIAN_ARGUMENTS"] = _arguments;
            how.EnvironmentVariables["PACINIAN_LOG"] = _log;
            how.EnvironmentVariables[ConnectionFile.Variable] = ConnectionFile.FindPath(_connection);
            _started = now;
            Rest(now);
            try
            {
                CreateTemporaryLog();
                _process = Process.Start(how);
                Problem = "";
            }
            catch (Exception error) when (error is Win32Exception || error is InvalidOperationException || error is NotSupportedException
                || error is IOException || error is UnauthorizedAccessException)
            {
                Problem = _program + " cannot be started: " + error.Message; // NotSupportedException: of IL2CPP
            }
            return _process != null;
        }

        /// <summary>Until the next start there is to be a pause, longer each time.</summary>
        private void Rest(double now)
        {
            _due = now + _pause;
            _pause = Math.Min(2.0 * _pause, LongestPause);
        }

        private void Bury(double now)
        {
            string said = LastLine();
            int code = _process.ExitCode;
            Problem = code == NotFound || code == NotFoundByWindows
                ? "the program " + _program + " was not found: install Pacinian, or give the program's full path (" + said + ")"
                : Describe(code) + (said.Length > 0 ? ": " + said : "");
            Forget();
            Rest(now);
        }

        private static string Describe(int code)
        {
            return code == Killed && !Windows ? "the server was killed (signal 9)"
                : "the server has ended, with exit code " + code.ToString(CultureInfo.InvariantCulture);
        }

        /// <summary>Creates it anew, so that the server does not follow a link that another user has put there.</summary>
        private void CreateTemporaryLog()
        {
            if (_temporaryLog)
            {
                DeleteTemporaryLog();
                new FileStream(_log, FileMode.CreateNew).Dispose();
            }
        }

        private void DeleteTemporaryLog()
        {
            try
            {
                if (_temporaryLog)
                {
                    File.Delete(_log);
                }
            }
            catch (Exception error) when (error is IOException || error is UnauthorizedAccessException)
            {
                // It stays.
            }
        }

        private string LastLine()
        {
            try
            {
                using (FileStream file = new FileStream(_log, FileMode.Open, FileAccess.Read, FileShare.ReadWrite))
                using (StreamReader reader = new StreamReader(file))
                {
                    file.Seek(-Math.Min(Tail, file.Length), SeekOrigin.End);
                    string[] lines = reader.ReadToEnd().TrimEnd().Split('\n');
                    return lines[lines.Length - 1].Trim();
                }
            }
            catch (Exception error) when (error is IOException || error is UnauthorizedAccessException)
            {
                return "";
            }
        }

        private void Kill()
        {
            try
            {
                _process.Kill();
            }
            catch (Exception error) when (error is Win32Exception || error is InvalidOperationException)
            {
                // It has just ended.
            }
        }

        private void Forget()
        {
            _process.Dispose();
            _process = null;
        }
    }
}
