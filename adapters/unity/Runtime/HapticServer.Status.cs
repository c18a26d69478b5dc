namespace Pacinian.Haptics
{
    /// <summary>How it stands with the server.</summary>
    public sealed partial class HapticServer
    {
        /// <summary>How it stands with the server.</summary>
        public ClientStatus Status
        {
            get { return Client == null ? ClientStatus.Stopped : Client.Status; }
        }

        /// <summary>Whether there is a session.</summary>
        public bool IsConnected
        {
            get { return Status == ClientStatus.Connected; }
        }

        /// <summary>Why there is no session and what to do, or what the server last refused; "" if all is well.</summary>
        public string Problem
        {
            get
            {
                return _waits ? Waiting
                    : IsConnected ? _refused
                    : StartedServer.Problem.Length > 0 ? StartedServer.Problem
                    : Client == null ? "" : Client.Problem;
            }
        }

        /// <summary>Why nothing can be felt, and what to do, as the nearest object and its distance; "" while something can.</summary>
        public string Silence
        {
            get { return Why.Text; }
        }

        /// <summary>The same for programs: a cause of docs/wire-messages.md, "not connected" or "not the owner"; "" if it sounds.</summary>
        public string SilenceCause
        {
            get { return Why.Cause; }
        }

        /// <summary>Whether this game's scene may be felt.</summary>
        public bool Armed
        {
            get { return Client != null && Client.Armed; }
        }

        /// <summary>Median round trip to the server [s]; 0 before the first.</summary>
        public double Latency
        {
            get { return Client == null ? 0.0 : Client.Latency; }
        }

        /// <summary>From the game's last frame to silence, as agreed with the server [s]; 0 without a session.</summary>
        public double GrantedLease
        {
            get { return Client == null ? 0.0 : Client.Lease; }
        }

        /// <summary>What the array does, as the server says.</summary>
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

        /// <summary>Solvers that the server has; none until it has told.</summary>
        public string[] Solvers
        {
            get { return Capabilities == null ? new string[0] : Names(Capabilities.Solvers); }
        }

        /// <summary>Backends that the server has; none until it has told.</summary>
        public string[] Backends
        {
            get { return Capabilities == null ? new string[0] : Names(Capabilities.Backends); }
        }

        /// <summary>What the server that is connected can do; null if none has told.</summary>
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
