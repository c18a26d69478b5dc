using System;
using UnityEngine;

namespace Pacinian.Haptics
{
    /// <summary>
    /// A pause that somebody asks for is no failure: the sound ends softly at once, and begins again when it goes on. A game
    /// that stood still unasked is silent when its lease is over, and sounds again when it goes on.
    /// </summary>
    public sealed partial class HapticServer
    {
        private int _pausedSession; // in which it was armed
        private bool _pauses, _armsAfterPause;

        /// <summary>The game stood still for longer than its lease, and goes on. It sounds again, unless something else ended it.</summary>
        public event Action<Standstill> StoodStill;

        /// <summary>The editor is paused, or goes on; or the app is in the background, or in front again.</summary>
        internal void Pause(bool pauses)
        {
            if (Client == null || pauses == _pauses)
            {
                return;
            }
            _pauses = pauses;
            if (pauses)
            {
                _armsAfterPause = Client.Armed;
                if (_armsAfterPause)
                {
                    _pausedSession = _session;
                    Client.Disarm();
                }
            }
            else if (_armsAfterPause)
            {
                _armsAfterPause = false;
                _arms = _arms || (_wanted && _session == _pausedSession); // after a loss it is as armAgainAfterLoss says
            }
        }

        /// <summary>While the editor is paused and calls no Update: the session goes on, and is silent.</summary>
        internal void KeepAlive()
        {
            if (_pauses && Client != null)
            {
                Client.Tick();
            }
        }

        private void OnApplicationPause(bool pauses)
        {
            Pause(pauses);
        }

        private void OnStoodStill(Standstill still)
        {
            Debug.Log("Pacinian: " + still, this);
            StoodStill?.Invoke(still);
        }
    }
}
