using Pacinian.Wire;

namespace Pacinian
{
    /// <summary>
    /// Why the output is silent for this client. The server finds it, but for what only a client knows. For some 30 ms after a
    /// command the newest state may be from before it, and name a cause that the command has just removed.
    /// </summary>
    public struct Silence
    {
        private const string Stopped = "the client is not started, or has ended: call Start";
        private const string NoState = "connected; the server has not sent its first state yet";

        /// <summary>For programs: the values of `cause` on the wire, "not connected" and "not the owner"; "" if it sounds.</summary>
        public string Cause;

        /// <summary>For people: what is the matter, and what to do; "" if it sounds.</summary>
        public string Text;

        /// <summary>In one line.</summary>
        public override string ToString()
        {
            return Text;
        }

        /// <summary>state: the newest one; null: there is none yet.</summary>
        internal static Silence Of(Standing standing, State state)
        {
            if (standing.Status != ClientStatus.Connected)
            {
                string why = standing.Problem.Length > 0 ? standing.Problem
                    : standing.Status == ClientStatus.Stopped ? Stopped : "it is connecting";
                return new Silence { Cause = "not connected", Text = why };
            }
            if (state == null)
            {
                return new Silence { Cause = "not connected", Text = NoState };
            }
            if (state.Owner.Length > 0 && !standing.Owner && state.Scene != standing.Scene)
            {
                string why = "\"" + state.Owner + "\" owns the output: end that program, or arm with `take`";
                return new Silence { Cause = "not the owner", Text = why };
            }
            return new Silence { Cause = state.Cause, Text = state.Why };
        }
    }
}
