using UnityEngine;

namespace Pacinian.Haptics
{
    /// <summary>Start and end. However a game ends, its connection ends with it, and then the sound.</summary>
    public sealed partial class HapticServer
    {
        private static int s_sessions; // counted over all instances; tells an effect whether the server has it

        private string _refused = "", _logged = "";
        private volatile string _unstopped = ""; // why an emergency stop was not confirmed
        private int _session;
        private bool _again, _waits;

        private void OnEnable()
        {
            All.Add(this);
            _waits = !ReferenceEquals(Current, this);
            if (_waits)
            {
                Debug.Log("Pacinian: " + Waiting, this);
                return;
            }
            if (keepAcrossScenes)
            {
                DontDestroyOnLoad(transform.root.gameObject);
            }
            Begin();
        }

        /// <summary>Why another instance is used.</summary>
        private string Waiting
        {
            get
            {
                return "the Haptic Server of \"" + name + "\" waits, because that of \"" + Current.name + "\" is used. "
                    + "Disable or remove one of them; this one takes over when the other is gone";
            }
        }

        private void Begin()
        {
            _waits = false;
            if (startServer)
            {
                StartedServer.Start(connectionFile);
            }
            if (connectOnPlay)
            {
                Open();
            }
        }

        private void Open()
        {
            _session = 0;
            _again = _pauses = _armsAfterPause = false;
            _wanted = armOnConnect;
            _refused = _logged = "";
            Client = new HapticClient(Choices());
            Client.Connected += OnConnected;
            Client.Lost += OnLost;
            Client.Ended += OnEnded;
            Client.Refused += OnRefused;
            Client.StateChanged += OnState;
            Client.StoodStill += OnStoodStill;
            Client.TouchBegan += OnTouchBegan;
            Client.TouchMoved += OnTouchMoved;
            Client.TouchEnded += OnTouchEnded;
            Client.Start();
        }

        private void OnDisable()
        {
            Close();
        }

        private void OnApplicationQuit()
        {
            Close();
        }

        private void Close()
        {
            All.Remove(this);
            Disconnect();
        }

        private void OnConnected()
        {
            _session = ++s_sessions;
            _refused = _logged = _unstopped = "";
            _selectionSender.Forget();
            _arms = _wanted && (_again ? armAgainAfterLoss : armOnConnect);
            _again = true;
            Connected?.Invoke();
        }

        private void OnLost(string why)
        {
            Log(why);
            Lost?.Invoke(why);
        }

        private void OnEnded(Refusal why)
        {
            _wanted = false;
            Told(why);
            Ended?.Invoke(why);
        }

        private void OnRefused(Refusal why)
        {
            HapticEffect.Refuse(Client, why);
            RefuseZones(why);
            Told(why);
            Refused?.Invoke(why);
        }

        private void OnState(Wire.State state)
        {
            StateChanged?.Invoke(state);
        }

        private void Told(Refusal why)
        {
            _refused = why.ToString();
            Log(_refused);
        }

        private void Log(string text)
        {
            if (text != _logged)
            {
                _logged = text;
                Debug.LogWarning("Pacinian: " + text, this);
            }
        }
    }
}
