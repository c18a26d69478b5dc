using System;
using System.ComponentModel;
using System.Diagnostics;
using System.Globalization;
using System.IO;
using System.Threading;

namespace Pacinian
{
    /// <summary>
    /// Starts the server as a child process: `pacinian serve`, as installed or as a standalone folder. The server ends
    /// with this program, even after a crash. If another server has written the connection file, none is started while
    /// the client can connect to that server. Belongs to one thread; only Stop blocks.
    /// </summary>
    public sealed class ServerProcess : IDisposable
    {
        private const double FirstPause = 2.0, LongestPause = 30.0; // [s] between two starts
        private const double ResetTime = 10.0; // [s] of running, after which the first pause applies again
        private const int PollInterval = 10; // [ms] between two checks whether the server has ended
        private const int LogTail = 2000; // [bytes] that are read of a log
        private const int NotFound = 127, NotFoundByWindows = 9009; // exit codes of a shell
        private const int Killed = 128 + 9; // exit code of a program that SIGKILL ended

        private static readonly bool Windows = Path.DirectorySeparatorChar == '\\';

        private readonly string _program, _connection, _log, _arguments;
        private readonly bool _temporaryLog;
        private Process _process;
        private bool _wanted;
        private double _started, _due, _pause = FirstPause;

        /// <summary>
        /// Creates a process that is not started. program: its path, or its name if the system finds it. connection:
        /// the connection file; "": where clients look for it. log: a file for its output, in a folder that exists; "":
        /// a temporary file, which Stop deletes. arguments: more arguments of `serve`, such as the path of a configuration; none may contain a
        /// space.
        /// </summary>
        public ServerProcess(string program, string connection = "", string log = "", string arguments = "")
        {
            _program = program;
            _connection = connection;
            _temporaryLog = log.Length == 0;
            _log = _temporaryLog ? Path.Combine(Path.GetTempPath(), "pacinian-" + Guid.NewGuid().ToString("N") + ".log") : log;
            _arguments = arguments;
        }

        /// <summary>Why the server does not run; "" if it does, or if the client is connected to another one.</summary>
        public string Problem { get; private set; } = "";

        /// <summary>Whether the server was started here, and has not ended.</summary>
        public bool Running
        {
            get { return _process != null && !_process.HasExited; }
        }

        /// <summary>Starts the server, unless another one runs. Returns false on failure; see Problem.</summary>
        public bool Start()
        {
            if (Running)
            {
                return true;
            }
            if (ConnectionFile.IsText(_connection))
            {
                Problem = "the connection is given as text, so its server runs elsewhere and none is started here: give the path of a"
                    + " connection file";
                return false;
            }
            _wanted = true;
            _pause = FirstPause;
            Problem = "";
            if (ConnectionFile.Read(_connection, out string _) == null)
            {
                return Begin(SteadyClock.Now());
            }
            ScheduleStart(SteadyClock.Now());
            return true;
        }

        /// <summary>
        /// Restarts the server if it has ended and the client is not connected to another one, after a pause of 2 s at
        /// first and of 30 s at most; call it once per frame.
        /// </summary>
        public void Tick(bool connected)
        {
            double now = SteadyClock.Now();
            if (!_wanted)
            {
                return;
            }
            if (_process != null && _process.HasExited)
            {
                NoteEnd(now);
            }
            Problem = connected ? "" : Problem;
            if (connected || (_process != null && now > _started + ResetTime))
            {
                _pause = FirstPause;
            }
            if (connected && _process == null)
            {
                ScheduleStart(now);
            }
            if (!connected && _process == null && now >= _due)
            {
                Begin(now);
            }
        }

        /// <summary>
        /// Stops the server, and with it all sound, if it was started here. Waits at most maxWait [s], then kills it.
        /// </summary>
        public void Stop(double maxWait = 5.0)
        {
            _wanted = false;
            if (_process != null)
            {
                _process.StandardInput.Close();
                for (double end = SteadyClock.Now() + maxWait; !_process.HasExited; Thread.Sleep(PollInterval))
                {
                    if (SteadyClock.Now() > end)
                    {
                        Kill();
                    }
                }
                Forget();
            }
            DeleteTemporaryLog();
        }

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
            ScheduleStart(now);
            try
            {
                CreateLog();
                _process = Process.Start(how);
                Problem = "";
            }
            catch (Exception error) when (error is IOException || error is UnauthorizedAccessException)
            {
                Problem = "the log " + _log + " cannot be written: " + error.Message + "; create its folder, or give another path";
            }
            catch (Exception error) when (error is Win32Exception || error is InvalidOperationException || error is NotSupportedException)
            {
                Problem = _program + " cannot be started: " + error.Message; // NotSupportedException: IL2CPP
            }
            return _process != null;
        }

        /// <summary>Schedules the next start, after a longer pause each time.</summary>
        private void ScheduleStart(double now)
        {
            _due = now + _pause;
            _pause = Math.Min(2.0 * _pause, LongestPause);
        }

        private void NoteEnd(double now)
        {
            string error = LastError();
            Problem = Describe(_process.ExitCode) + (error.Length > 0 ? ": " + error : "");
            Forget();
            ScheduleStart(now);
        }

        private string Describe(int code)
        {
            if (code == NotFound || code == NotFoundByWindows)
            {
                return "the program " + _program + " was not found: install Pacinian, or give the program's full path";
            }
            return code == Killed && !Windows ? "the server was killed (signal 9)"
                : "the server has ended, with exit code " + code.ToString(CultureInfo.InvariantCulture);
        }

        /// <summary>
        /// Creates the log file, to find out whether that is possible; a temporary one anew, so that the server does not
        /// follow a link of another user.
        /// </summary>
        private void CreateLog()
        {
            DeleteTemporaryLog();
            new FileStream(_log, _temporaryLog ? FileMode.CreateNew : FileMode.OpenOrCreate).Dispose();
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

        /// <summary>Returns the last line of the log that reports an error; "" if there is none.</summary>
        private string LastError()
        {
            try
            {
                using (FileStream file = new FileStream(_log, FileMode.Open, FileAccess.Read, FileShare.ReadWrite))
                using (StreamReader reader = new StreamReader(file))
                {
                    file.Seek(-Math.Min(LogTail, file.Length), SeekOrigin.End);
                    string[] lines = reader.ReadToEnd().Split('\n');
                    string last = Array.FindLast(lines, line => line.IndexOf("error", StringComparison.OrdinalIgnoreCase) >= 0);
                    return last == null ? "" : last.Trim();
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
