using System;
using System.Collections.Generic;
using UnityEngine;

namespace Pacinian.Haptics
{
    /// <summary>
    /// The connection to `pacinian serve`. All other components find it. It connects by itself, again and again, and nothing
    /// here waits for the server. The first that is enabled is used; others wait, say so, and one takes over when it goes.
    /// </summary>
    [DisallowMultipleComponent]
    [DefaultExecutionOrder(1000)]
    [AddComponentMenu("Pacinian/Haptic Server")]
    public sealed partial class HapticServer : MonoBehaviour
    {
        [SerializeField, Tooltip("Connection file of the server; empty: where a server on this machine writes it.")]
        private string connectionFile = "";
        [SerializeField, Tooltip("Who this is, for people; empty: the product's name.")]
        private string clientName = "";
        [SerializeField, Tooltip("Clients that give the same name share a scene; empty: one of its own.")]
        private string sceneName = "";
        [SerializeField, Tooltip("Silence if no frame comes for so long [s]; 0: the server's, which is the most.")]
        [Range(0f, 10f)]
        private float lease;
        [SerializeField, Tooltip("Starts a server on this computer, unless one runs; it ends with the game.")]
        private bool startServer;
        [SerializeField, Tooltip("Connects when it is enabled; else when Connect is called.")]
        private bool connectOnPlay = true;
        [SerializeField, Tooltip("The first connection makes the scene felt.")]
        private bool armOnConnect = true;
        [SerializeField, Tooltip("Also after the connection was lost, if it was armed before.")]
        private bool armAgainAfterLoss;
        [SerializeField, Tooltip("Arming takes the output from another program.")]
        private bool takeOver;
        [SerializeField, Tooltip("Its object, with all above and below it, stays when another scene is loaded.")]
        private bool keepAcrossScenes;
        [SerializeField, Tooltip("Factor on all radiation pressures."), Range(0f, 1f)]
        private float intensity = 1f;
        [SerializeField, Tooltip("Empty: the server's.")]
        private string solver = "";
        [SerializeField, Tooltip("Empty: the server's.")]
        private string backend = "";

        internal static readonly List<HapticServer> All = new List<HapticServer>();

        private bool _wanted;

        /// <summary>The one that is used: the first that is enabled; null if there is none.</summary>
        public static HapticServer Current
        {
            get { return All.Count > 0 ? All[0] : null; }
        }

        /// <summary>There is a session. Objects are put by themselves.</summary>
        public event Action Connected;

        /// <summary>The session is over, and why.</summary>
        public event Action<string> Lost;

        /// <summary>It does not sound any more, unasked: owner, stopped or fault.</summary>
        public event Action<Refusal> Ended;

        /// <summary>What the server would not do.</summary>
        public event Action<Refusal> Refused;

        /// <summary>The newest state has come; it is good until the next frame.</summary>
        public event Action<Wire.State> StateChanged;

        /// <summary>The engine-free client, for what is not here; null while this is disabled.</summary>
        public HapticClient Client { get; private set; }

        /// <summary>This scene is to be felt, as <see cref="TakeOver"/> says. False: there is no session.</summary>
        public bool Arm()
        {
            bool asked = Client != null && Client.Arm(takeOver);
            _wanted = _wanted || asked;
            return asked;
        }

        /// <summary>Silence, softly; the output is let go.</summary>
        public bool Disarm()
        {
            _wanted = _armsAfterPause = false;
            return Client != null && Client.Disarm();
        }

        /// <summary>Begins to connect, with the settings as they are now.</summary>
        public void Connect()
        {
            if (Client == null && ReferenceEquals(Current, this))
            {
                Open();
            }
        }

        /// <summary>Ends the session: silence. It waits for half a second at most.</summary>
        public void Disconnect()
        {
            HapticClient client = Client;
            Client = null;
            _session = 0;
            if (client != null)
            {
                client.Dispose();
            }
        }

        /// <summary>A new session in place of the one there is.</summary>
        public void Reconnect()
        {
            Disconnect();
            Connect();
        }

        /// <summary>Silence at once, whoever owns the output, until <see cref="ResetOutput"/>. Also while disabled.</summary>
        public void EmergencyStop()
        {
            _wanted = _armsAfterPause = false;
            (Client ?? new HapticClient(Choices())).Stop();
        }

        /// <summary>After an emergency stop or a fault: it may be armed again.</summary>
        public bool ResetOutput()
        {
            return Client != null && Client.Reset();
        }

        /// <summary>Ends the server that this program has started, if it has: silence. It waits for five seconds at most.</summary>
        public static void StopServer()
        {
            StartedServer.Stop();
        }

        /// <summary>Ends the connection of whatever instance has one, and the server that was started: silence.</summary>
        internal static void ShutDown()
        {
            while (All.Count > 0)
            {
                All[All.Count - 1].Close();
            }
            StartedServer.Stop();
        }

        internal Options Choices()
        {
            string name = string.IsNullOrEmpty(clientName) ? Application.productName : clientName;
            return new Options
            {
                ConnectionPath = connectionFile,
                Name = string.IsNullOrEmpty(name) ? "Unity" : name.Length > 64 ? name.Substring(0, 64) : name,
                Version = Application.version.Length > 64 ? "" : Application.version,
                Scene = sceneName,
                Lease = lease,
            };
        }
    }
}
