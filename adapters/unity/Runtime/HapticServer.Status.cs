namespace Pacinian.Haptics
{
    /// <summary>State of the connection and of the output.</summary>
    public sealed partial class HapticServer
    {
        /// <summary>The state of the connection.</summary>
        public ClientStatus Status
        {
            get { return Client == null ? ClientStatus.Stopped : Client.Status; }
        }

        /// <summary>Whether there is a session.</summary>
        public bool IsConnected
        {
            get { return Status == ClientStatus.Connected; }
        }

        /// <summary>
        /// Why an emergency stop was not confirmed, or there is no session, and what to do, or the server's last refusal; ""
        /// if there is no problem.
        /// </summary>
        public string Problem
        {
            get
            {
                return _unstopped.Length > 0 ? _unstopped
                    : _waits ? Waiting
                    : IsConnected ? _refused
                    : StartedServer.Problem.Length > 0 ? StartedServer.Problem
                    : Client == null ? "" : Client.Problem;
            }
        }

        /// <summary>
        /// Why nothing can be felt, and what to do (for example, the nearest object and its distance); "" if something
        /// can.
        /// </summary>
        public string Silence
        {
            get { return Why.Text; }
        }

        /// <summary>
        /// The cause of silence for programs, one of docs/wire-messages.md, "not connected" or "not the owner"; "" if
        /// it sounds.
        /// </summary>
        public string SilenceCause
        {
            get { return Why.Cause; }
        }

        /// <summary>Whether this client has armed the output.</summary>
        public bool Armed
        {
            get { return Client != null && Client.Armed; }
        }

        /// <summary>The median round trip to the server [s]; 0 before the first.</summary>
        public double Latency
        {
            get { return Client == null ? 0.0 : Client.Latency; }
        }

        /// <summary>The time from the game's last frame to silence, as granted by the server [s]; 0 without a session.</summary>
        public double GrantedLease
        {
            get { return Client == null ? 0.0 : Client.Lease; }
        }

        /// <summary>The state of the output, as the server reports it.</summary>
        public HapticOutput Output
        {
            get { return Client == null || Client.State == null ? HapticOutput.Unknown : 1 + (HapticOutput)Client.State.Output; }
        }

        private Silence Why
        {
            get
            {
                string problem = _waits ? Waiting : IsConnected ? "" : StartedServer.Problem;
                return problem.Length > 0 ? new Silence { Cause = "not connected", Text = problem }
                    : Client != null ? Client.Silence
                    : new Silence { Cause = "not connected", Text = "Haptic Server is not connected: call Connect, or enable it" };
            }
        }

        /// <summary>The server's solvers; empty until it has reported them.</summary>
        public string[] Solvers
        {
            get { return Capabilities == null ? new string[0] : Names(Capabilities.Solvers); }
        }

        /// <summary>The server's backends; empty until it has reported them.</summary>
        public string[] Backends
        {
            get { return Capabilities == null ? new string[0] : Names(Capabilities.Backends); }
        }

        /// <summary>The capabilities of the connected server; null until it has reported them.</summary>
        internal static Wire.Abilities Capabilities
        {
            get { return Current == null || Current.Client == null ? null : Current.Client.Capabilities; }
        }

        private static string[] Names(Wire.Items<Wire.Plugin> plugins)
        {
            string[] names = new string[plugins.Count];
            for (int i = 0; i < names.Length; i++)
            {
                names[i] = plugins[i].Name;
            }
            return names;
        }
    }
}
