using UnityEngine;

namespace Pacinian.Haptics
{
    /// <summary>How it is to connect, and what is to sound.</summary>
    public sealed partial class HapticServer
    {
        /// <summary>
        /// Connection file, or its content, which begins with {, as on a headset; "": where a server on this machine writes it. From
        /// the next connection on, as all to Lease.
        /// </summary>
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

        /// <summary>
        /// Whether a server is started on this computer, unless one runs: the one in StreamingAssets/pacinian, or the one that the
        /// project's settings name. It ends with the game. Set while this is used, it starts at once.
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

        /// <summary>Whether its object, with all above and below it, stays when another scene is loaded. Before it is enabled.</summary>
        public bool KeepAcrossScenes
        {
            get { return keepAcrossScenes; }
            set { keepAcrossScenes = value; }
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
    }
}
