using UnityEngine;

namespace Pacinian.Haptics
{
    /// <summary>How it is to connect and what is to sound, and how it stands.</summary>
    public sealed partial class HapticServer
    {
        /// <summary>Connection file; "": where a server on this machine writes it. From the next connection on, as all to Lease.</summary>
        public string ConnectionFile
        {
            get { return connectionFile; }
            set { connectionFile = value ?? ""; }
        }

        /// <summary>Who this is, for people; "": the product's name.</summary>
        public string ClientName
        {
            get { return clientName; }
            set { clientName = value ?? ""; }
        }

        /// <summary>Programs that give the same name share a scene; "": one of its own.</summary>
        public string SceneName
        {
            get { return sceneName; }
            set { sceneName = value ?? ""; }
        }

        /// <summary>From the game's last frame to silence [s]; 0: as long as the server allows.</summary>
        public float Lease
        {
            get { return lease; }
            set { lease = value; }
        }

        /// <summary>Whether it connects when it is enabled.</summary>
        public bool ConnectOnPlay
        {
            get { return connectOnPlay; }
            set { connectOnPlay = value; }
        }

        /// <summary>Whether the first connection makes the scene felt.</summary>
        public bool ArmOnConnect
        {
            get { return armOnConnect; }
            set { armOnConnect = value; }
        }

        /// <summary>Whether it sounds again after the connection was lost, if it was armed before.</summary>
        public bool ArmAgainAfterLoss
        {
            get { return armAgainAfterLoss; }
            set { armAgainAfterLoss = value; }
        }

        /// <summary>Whether arming takes the output from another program that has it.</summary>
        public bool TakeOver
        {
            get { return takeOver; }
            set { takeOver = value; }
        }

        /// <summary>Factor on all radiation pressures, 0..1; told to the server at most ten times a second.</summary>
        public float Intensity
        {
            get { return intensity; }
            set { intensity = Mathf.Clamp01(value); }
        }

        /// <summary>What computes the array's output, by its name in the solvers; "": as it is.</summary>
        public string Solver
        {
            get { return solver; }
            set { solver = value ?? ""; }
        }

        /// <summary>The array, by its name in the backends; "": as it is.</summary>
        public string Backend
        {
            get { return backend; }
            set { backend = value ?? ""; }
        }

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
            get { return IsConnected ? _refused : Client == null ? "" : Client.Problem; }
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
                return Client != null ? Client.Silence
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
