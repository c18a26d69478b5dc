using Pacinian.Wire;

namespace Pacinian
{
    /// <summary>The state of a client's connection.</summary>
    public enum ClientStatus
    {
        /// <summary>The client was not started, or has ended.</summary>
        Stopped,

        /// <summary>The client tries to connect; its problem says what it waits for.</summary>
        Connecting,

        /// <summary>There is a session.</summary>
        Connected,

        /// <summary>The server rejects the client, whose problem says what to do. The client tries again.</summary>
        Refused,
    }

    /// <summary>A command or request that the server refused.</summary>
    public struct Refusal
    {
        /// <summary>The code, from the protocol's table of errors.</summary>
        public string Code;

        /// <summary>What is wrong, for people.</summary>
        public string Message;

        /// <summary>The wrong field, such as `$.objects[ball].shape`; or "".</summary>
        public string Path;

        /// <summary>What to do; or "".</summary>
        public string Advice;

        /// <summary>Returns the refusal in one line.</summary>
        public override string ToString()
        {
            string at = string.IsNullOrEmpty(Path) ? "" : " (" + Path + ")";
            return Code + ": " + Message + at + (string.IsNullOrEmpty(Advice) ? "" : "; " + Advice);
        }
    }

    /// <summary>A snapshot of the client's state.</summary>
    internal struct SessionState
    {
        public ClientStatus Status;
        public string Problem;
        public bool Armed, Owner;
        public double Lease;
        public string Scene, Server;
        public Abilities Abilities;

        /// <summary>The number of the session, from 1 on; 0 if there is none.</summary>
        public int Session;

        /// <summary>Returns the state without a session.</summary>
        public static SessionState None(ClientStatus status, string problem)
        {
            return new SessionState { Status = status, Problem = problem, Scene = "", Server = "" };
        }
    }
}
