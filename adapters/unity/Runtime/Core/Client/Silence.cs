using Pacinian.Wire;

namespace Pacinian
{
    /// <summary>
    /// Why the output is silent for this client. The server determines the cause, except for what only the client
    /// knows. For about 30 ms after a command, the newest state may be older than the command, and give a cause that
    /// the command has just removed.
    /// </summary>
    public struct Silence
    {
        private const string NotStarted = "the client is not started, or has ended: call Start";
        private const string NoState = "connected; the server has not sent its first state yet";

        /// <summary>For programs: a value of `cause` on the wire, "not connected" or "not the owner"; "" if it sounds.</summary>
        public string Cause;

        /// <summary>For people: the cause and what to do; "" if it sounds.</summary>
        public string Text;

        /// <summary>Returns the text.</summary>
        public override string ToString()
        {
            return Text;
        }

        /// <summary>state: the newest one; null if there is none yet.</summary>
        internal static Silence Of(SessionState sessionState, State state)
        {
            if (sessionState.Status != ClientStatus.Connected)
            {
                string why = sessionState.Problem.Length > 0 ? sessionState.Problem
                    : sessionState.Status == ClientStatus.Stopped ? NotStarted : "it is connecting";
                return new Silence { Cause = "not connected", Text = why };
            }
            if (state == null)
            {
                return new Silence { Cause = "not connected", Text = NoState };
            }
            bool ended = state.Cause == "stopped" || state.Cause == "fault"; // for every client
            if (!ended && state.Owner.Length > 0 && !sessionState.Owner && state.Scene != sessionState.Scene)
            {
                string why = "\"" + state.Owner + "\" owns the output: end that program, or arm with `take`";
                return new Silence { Cause = "not the owner", Text = why };
            }
            return new Silence { Cause = state.Cause, Text = state.Why };
        }
    }
}
