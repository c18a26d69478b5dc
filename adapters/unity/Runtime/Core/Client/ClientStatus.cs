using Pacinian.Wire;

namespace Pacinian
{
    /// <summary>How a client stands with the server.</summary>
    public enum ClientStatus
    {
        /// <summary>Not started, or ended.</summary>
        Stopped,

        /// <summary>It tries to connect; the client's problem says what it waits for.</summary>
        Connecting,

        /// <summary>There is a session.</summary>
        Connected,

        /// <summary>The server is there and will not have us; the client's problem says what to do. It tries again.</summary>
        Refused,
    }

    /// <summary>What the server would not do.</summary>
    public struct Refusal
    {
        /// <summary>As in the protocol's table of errors.</summary>
        public string Code;

        /// <summary>What is wrong, for people.</summary>
        public string Message;

        /// <summary>The field that is wrong, as `$.objects[ball].shape`; or "".</summary>
        public string Path;

        /// <summary>What to do; or "".</summary>
        public string Advice;

        /// <summary>In one line.</summary>
        public override string ToString()
        {
            string at = string.IsNullOrEmpty(Path) ? "" : " (" + Path + ")";
            return Code + ": " + Message + at + (string.IsNullOrEmpty(Advice) ? "" : "; " + Advice);
        }
    }

    /// <summary>How a client stands, all at one moment.</summary>
    internal struct Standing
    {
        public ClientStatus Status;
        public string Problem;
        public bool Armed, Owner;
        public double Lease;
        public string Scene, Server;
        public Abilities Abilities;

        /// <summary>Counts sessions; 0 while there is none.</summary>
        public int Session;

        /// <summary>Without a session.</summary>
        public static Standing None(ClientStatus status, string problem)
        {
            return new Standing { Status = status, Problem = problem, Scene = "", Server = "" };
        }
    }
}
