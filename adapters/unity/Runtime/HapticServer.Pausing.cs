using System;
using UnityEngine;

namespace Pacinian.Haptics
{
    /// <summary>
    /// An intended pause is not a failure: the sound fades at once, and returns when the game continues. If a game
    /// stands still unintentionally, it is silent once its lease is over, and sounds again when it continues.
    /// </summary>
    public sealed partial class HapticServer
    {
        private int _pausedSession; // in which the output was owned
        private bool _pauses, _armsAfterPause, _disarmAsked;

        /// <summary>
        /// The game continues after standing still for longer than its lease. It sounds again, unless something else
        /// ended the sound.
        /// </summary>
        public event Action<Standstill> StoodStill;

        /// <summary>Handles a pause of the editor or of the app (in the background), and its end.</summary>
        internal void Pause(bool pauses)
        {
            if (Client == null || pauses == _pauses)
            {
                return;
            }
            _pauses = pauses;
            if (pauses)
            {
                _armsAfterPause = _disarmAsked = false;
                DisarmIfOwner();
            }
            else if (_armsAfterPause)
            {
                _armsAfterPause = false;
                _arms = _arms || (_wanted && _session == _pausedSession); // after a loss, armAgainAfterLoss decides
            }
        }

        /// <summary>Keeps the session alive, in silence, while the editor is paused and calls no Update.</summary>
        internal void KeepAlive()
        {
            if (_pauses && Client != null)
            {
                Client.Tick();
                DisarmIfOwner();
            }
        }

        /// <summary>
        /// Disarms if this client owns the output. It may learn so only during the pause: an answer to `arm` may be under way,
        /// and a lease that ran out begins again with the next renewal.
        /// </summary>
        private void DisarmIfOwner()
        {
            bool asked = _disarmAsked;
            _disarmAsked = Client != null && Client.Owner;
            if (_disarmAsked && !asked)
            {
                _armsAfterPause = true;
                _pausedSession = _session;
                Client.Disarm();
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
