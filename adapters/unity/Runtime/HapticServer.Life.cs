using UnityEngine;

namespace Pacinian.Haptics
{
    /// <summary>Begin and end: whatever ends a game, its connection ends with it, and with that the sound.</summary>
    public sealed partial class HapticServer
    {
        private static int s_sessions; // of all instances: an effect knows by it whether the server has it

        private string _refused = "", _logged = "";
        private int _session;
        private bool _again;

        private void OnEnable()
        {
            if (Current is object)
            {
                Debug.LogWarning(
                    "Pacinian: \"" + Current.name + "\" has a Haptic Server already, so that of \"" + name
                    + "\" does nothing. Keep one, with DontDestroyOnLoad if scenes are changed", this);
                return;
            }
            Current = this;
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
            if (ReferenceEquals(Current, this))
            {
                Current = null;
            }
            Disconnect();
        }

        private void OnConnected()
        {
            _session = ++s_sessions;
            _refused = _logged = "";
            _changing.Forget();
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
