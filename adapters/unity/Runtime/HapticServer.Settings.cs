using UnityEngine;

namespace Pacinian.Haptics
{
    /// <summary>Settings of the connection and of the output.</summary>
    public sealed partial class HapticServer
    {
        /// <summary>
        /// The path of the connection file, or its content (which begins with {), as on a headset; "": the place where
        /// a server on this machine writes it. This and the settings up to Lease take effect with the next connection.
        /// </summary>
        public string ConnectionFile
        {
            get { return connectionFile; }
            set { connectionFile = value ?? ""; }
        }

        /// <summary>The name of this client, shown to people; "": the product's name.</summary>
        public string ClientName
        {
            get { return clientName; }
            set { clientName = value ?? ""; }
        }

        /// <summary>Clients with the same name share a scene; "": a scene of its own.</summary>
        public string SceneName
        {
            get { return sceneName; }
            set { sceneName = value ?? ""; }
        }

        /// <summary>The time from the game's last frame to silence [s]; 0: the longest that the server allows.</summary>
        public float Lease
        {
            get { return lease; }
            set { lease = value; }
        }

        /// <summary>
        /// Whether to start a server on this computer, unless one runs: the one in StreamingAssets/pacinian, or the one
        /// in the project's settings. It ends with the game. If this component is in use, setting it starts the server
        /// at once.
        /// </summary>
        public bool StartServer
        {
            get { return startServer; }
            set
            {
                startServer = value;
                if (value && ReferenceEquals(Current, this) && !_waits)
                {
                    StartedServer.Start(connectionFile);
                }
            }
        }

        /// <summary>
        /// Whether the object, with its parents and children, stays when another scene is loaded. Set it before
        /// enabling the component.
        /// </summary>
        public bool KeepAcrossScenes
        {
            get { return keepAcrossScenes; }
            set { keepAcrossScenes = value; }
        }

        /// <summary>Whether to connect when this component is enabled.</summary>
        public bool ConnectOnPlay
        {
            get { return connectOnPlay; }
            set { connectOnPlay = value; }
        }

        /// <summary>Whether the first connection arms the output.</summary>
        public bool ArmOnConnect
        {
            get { return armOnConnect; }
            set { armOnConnect = value; }
        }

        /// <summary>Whether to arm again after the connection was lost, if the output was armed before.</summary>
        public bool ArmAgainAfterLoss
        {
            get { return armAgainAfterLoss; }
            set { armAgainAfterLoss = value; }
        }

        /// <summary>Whether arming takes the output from another client that has it.</summary>
        public bool TakeOver
        {
            get { return takeOver; }
            set { takeOver = value; }
        }

        /// <summary>Factor on all radiation pressures, 0..1. It is sent at most ten times a second.</summary>
        public float Intensity
        {
            get { return intensity; }
            set { intensity = Mathf.Clamp01(value); }
        }

        /// <summary>The solver, by a name in <see cref="Solvers"/>; "": the server's.</summary>
        public string Solver
        {
            get { return solver; }
            set { solver = value ?? ""; }
        }

        /// <summary>The backend of the array, by a name in <see cref="Backends"/>; "": the server's.</summary>
        public string Backend
        {
            get { return backend; }
            set { backend = value ?? ""; }
        }
    }
}
