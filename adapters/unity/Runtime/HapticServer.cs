using System;
using System.Collections.Generic;
using UnityEngine;

namespace Pacinian.Haptics
{
    /// <summary>
    /// The connection to `pacinian serve`, which all other components use. It connects, and reconnects, by itself, and
    /// never blocks the game. The first component that is enabled is used. The others wait and say so; one takes over
    /// when the first is gone.
    /// </summary>
    [DisallowMultipleComponent]
    [DefaultExecutionOrder(1000)]
    [AddComponentMenu("Pacinian/Haptic Server")]
    public sealed partial class HapticServer : MonoBehaviour
    {
        [SerializeField, Tooltip("Connection file of the server; empty: the place where a server on this machine writes it.")]
        private string connectionFile = "";
        [SerializeField, Tooltip("Name of this client, shown to people; empty: the product's name.")]
        private string clientName = "";
        [SerializeField, Tooltip("Clients with the same name share a scene; empty: a scene of its own.")]
        private string sceneName = "";
        [SerializeField, Tooltip("Silence if no frame comes for this time [s]; 0: the longest that the server allows.")]
        [Range(0f, LongestLease)]
        private float lease;
        [SerializeField, Tooltip("Start a server on this computer, unless one runs. It ends with the game.")]
        private bool startServer;
        [SerializeField, Tooltip("Connect when enabled. Otherwise, call Connect.")]
        private bool connectOnPlay = true;
        [SerializeField, Tooltip("The first connection arms the output.")]
        private bool armOnConnect = true;
        [SerializeField, Tooltip("Arm again after the connection was lost, if the output was armed before.")]
        private bool armAgainAfterLoss;
        [SerializeField, Tooltip("Arming takes the output from another client.")]
        private bool takeOver;
        [SerializeField, Tooltip("The object, with its parents and children, stays when another scene is loaded.")]
        private bool keepAcrossScenes;
        [SerializeField, Tooltip("Factor on all radiation pressures."), Range(0f, 1f)]
        private float intensity = 1f;
        [SerializeField, Tooltip("Name of the solver; empty: the server's.")]
        private string solver = "";
        [SerializeField, Tooltip("Name of the backend; empty: the server's.")]
        private string backend = "";

        internal static readonly List<HapticServer> All = new List<HapticServer>();

        private const float ShortestLease = 0.05f, LongestLease = 10f; // [s]

        private bool _wanted;

        /// <summary>The component in use: the first that was enabled; null if there is none.</summary>
        public static HapticServer Current
        {
            get { return All.Count > 0 ? All[0] : null; }
        }

        /// <summary>A session has started. Objects are sent by themselves.</summary>
        public event Action Connected;

        /// <summary>The session has ended. The argument is the reason.</summary>
        public event Action<string> Lost;

        /// <summary>The output ended unasked: another owner, an emergency stop or a fault.</summary>
        public event Action<Refusal> Ended;

        /// <summary>The server refused a command.</summary>
        public event Action<Refusal> Refused;

        /// <summary>A new state has arrived. It is valid until the next frame.</summary>
        public event Action<Wire.State> StateChanged;

        /// <summary>The engine-independent client, for what this component does not offer; null while disabled.</summary>
        public HapticClient Client { get; private set; }

        /// <summary>Arms the output, so that this scene is felt; see <see cref="TakeOver"/>. Returns false without a session.</summary>
        public bool Arm()
        {
            bool asked = Client != null && Client.Arm(takeOver);
            _wanted = _wanted || asked;
            return asked;
        }

        /// <summary>Disarms: the sound fades, and the output is released.</summary>
        public bool Disarm()
        {
            _wanted = _arms = _armsAfterPause = false;
            return Client != null && Client.Disarm();
        }

        /// <summary>Starts to connect, with the present settings.</summary>
        public void Connect()
        {
            if (Client == null && ReferenceEquals(Current, this))
            {
                Open();
            }
        }

        /// <summary>Ends the session and the sound. Waits for half a second at most.</summary>
        public void Disconnect()
        {
            HapticClient client = Client;
            Client = null;
            _session = 0;
            if (client != null)
            {
                List<HandTouch> touches = new List<HandTouch>(client.Touches);
                client.Dispose();
                touches.ForEach(OnTouchEnded); // because Dispose raises no events
            }
        }

        /// <summary>Replaces the session by a new one.</summary>
        public void Reconnect()
        {
            Disconnect();
            Connect();
        }

        /// <summary>
        /// Silences the array at once, whoever owns the output, until <see cref="ResetOutput"/>. Works even while
        /// disabled, and in the editor. If the server does not confirm it, the console and <see cref="Problem"/> say so.
        /// </summary>
        public void EmergencyStop()
        {
            _wanted = _arms = _armsAfterPause = false;
            _unstopped = "";
            (Client ?? new HapticClient(Choices())).Stop(why =>
            {
                _unstopped = why.ToString();
                LogUnstopped(why);
            });
        }

        /// <summary>Logs that an emergency stop was not confirmed; on any thread.</summary>
        internal static void LogUnstopped(Refusal why)
        {
            Debug.LogError("Pacinian: " + why);
        }

        /// <summary>Allows arming again after an emergency stop or a fault.</summary>
        public bool ResetOutput()
        {
            _unstopped = "";
            return Client != null && Client.Reset();
        }

        /// <summary>
        /// Stops the server that this program has started, if any, and with it the sound. Waits for five seconds at
        /// most.
        /// </summary>
        public static void StopServer()
        {
            StartedServer.Stop();
        }

        /// <summary>Ends the connection of any instance, and the server that was started.</summary>
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
                Lease = lease > 0f ? Mathf.Clamp(lease, ShortestLease, LongestLease) : 0.0,
            };
        }
    }
}
