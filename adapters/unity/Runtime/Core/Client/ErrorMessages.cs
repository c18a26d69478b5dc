using System;
using System.Globalization;
using System.Text;
using Pacinian.Wire;

namespace Pacinian
{
    /// <summary>
    /// Messages for people that say what is wrong, and what to do. Those about the connection file are in
    /// ConnectionFile.cs.
    /// </summary>
    internal static class ErrorMessages
    {
        private const string NoLibrary = "this server requires CURVE keys, so this program needs the library libzmq (4.3 or newer), but "
            + "libzmq is not installed: in Unity, Window > Pacinian > Server copies it; otherwise install libzmq5 (Debian) or zeromq "
            + "(Homebrew), or put libzmq.dll beside the program; a server on this machine that uses a token needs no libzmq: ";

        /// <summary>Appended to the reason for the end of a session that had begun.</summary>
        public const string SessionOverSuffix = "; nothing of this session goes on";

        /// <summary>Returns why the connection to an address has ended. why: the transport's reason, or "".</summary>
        public static string DescribeEnding(Ending ending, string at, string why)
        {
            return DescribeEnding(ending, at) + (why.Length > 0 && ending != Ending.Denied ? ": " + why : "");
        }

        private static string DescribeEnding(Ending ending, string at)
        {
            switch (ending)
            {
                case Ending.Nobody:
                    return "the server at " + at + " does not answer: is `pacinian serve` running?";
                case Ending.Denied:
                    return "the server at " + at + " refuses the token or key: it does not know it, or was started again since";
                case Ending.Foreign:
                    return "the server at " + at + " is no Pacinian server, wants other security (CURVE keys or a token), or is too busy";
                default:
                    return "the server at " + at + " has gone";
            }
        }

        /// <summary>Returns the refusal of an error reply.</summary>
        public static Refusal MakeRefusal(Error error)
        {
            string advice = error.Advice;
            if (error.Code == Code.Version && advice.Length == 0)
            {
                advice = "update the older of the two: this client speaks " + Protocol.Major + "." + Protocol.Minor;
            }
            string code = Encoding.ASCII.GetString(Words.Code[(int)error.Code]);
            return new Refusal { Code = code, Message = error.Message, Path = error.Path, Advice = advice };
        }

        /// <summary>Returns what is wrong with the options that the server does not see; "" if nothing is.</summary>
        public static string WrongOption(Options options)
        {
            bool lives = options.Life > 0.0;
            string value = (lives ? options.Timeout : options.Life).ToString(CultureInfo.InvariantCulture);
            return lives && options.Timeout > 0.0 ? ""
                : "the option `" + (lives ? "Timeout" : "Life") + "` is " + value + " s: it must be more than 0 s";
        }

        /// <summary>Returns the message for an answer that did not arrive in time [s].</summary>
        public static string Hangs(string what, double seconds)
        {
            string time = seconds.ToString(CultureInfo.InvariantCulture);
            return "no answer to `" + what + "` within " + time + " s: the server hangs";
        }

        /// <summary>Returns the message for an exception that has ended a thread or a transport of the client.</summary>
        public static string DescribeException(Exception error)
        {
            return Transports.IsMissingLibrary(error) ? NoLibrary + error.Message : "the client has failed: " + error;
        }

        /// <summary>Returns the message for different major versions: it asks for an update of the older side.</summary>
        public static string Version(long theirs)
        {
            string older = theirs < Protocol.Major ? "server" : "client";
            return "the server speaks protocol " + theirs + ", this client " + Protocol.Major + ": update the " + older;
        }

        /// <summary>Returns the refusal for a reply that the client cannot decode.</summary>
        public static Refusal Unreadable(string problem, string path)
        {
            return new Refusal
            {
                Code = "malformed",
                Message = "the server's answer cannot be read: " + problem,
                Path = path,
                Advice = "update the older of client and server",
            };
        }

        /// <summary>Returns the refusal for a command without a session.</summary>
        public static Refusal NoSession(string what, bool started)
        {
            return new Refusal
            {
                Code = "session",
                Message = "`" + what + "` was asked for, but there is no session",
                Path = "",
                Advice = started ? "do it when Connected is raised" : "call Start, and do it when Connected is raised",
            };
        }

        /// <summary>Returns the refusal for a call from another thread than the game's.</summary>
        public static Refusal WrongThread(string call)
        {
            return new Refusal
            {
                Code = "thread",
                Message = "`" + call + "` was called from another thread than `Tick`, and did nothing",
                Path = "",
                Advice = "call it from the thread that calls Tick; only Stop may be called from any",
            };
        }

        /// <summary>Returns the refusal for an emergency stop that was not confirmed.</summary>
        public static Refusal Unstopped(string problem)
        {
            return new Refusal
            {
                Code = "stop",
                Message = "the stop was not confirmed: " + problem,
                Path = "",
                Advice = "`pacinian stop`, or switch the array off",
            };
        }
    }
}
