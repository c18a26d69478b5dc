using System;
using UnityEngine;

namespace Pacinian.Haptics
{
    /// <summary>Events of hands that touch an effect.</summary>
    public abstract partial class HapticEffect
    {
        [SerializeField, Tooltip("Invoked when a hand begins to feel the effect.")]
        private HapticTouchEvent touchBegins = new HapticTouchEvent();
        [SerializeField, Tooltip("Invoked when a hand no longer feels the effect.")]
        private HapticTouchEvent touchEnds = new HapticTouchEvent();

        /// <summary>A hand begins to feel the effect.</summary>
        public event Action<HapticTouch> TouchBegan;

        /// <summary>A hand no longer feels the effect. The argument is the last report of the touch.</summary>
        public event Action<HapticTouch> TouchEnded;

        /// <summary>Returns the effect that has this name on the server; null if there is none.</summary>
        internal static HapticEffect Named(string name)
        {
            for (int i = 0; i < All.Count; i++)
            {
                if (All[i]._name == name)
                {
                    return All[i];
                }
            }
            return null;
        }

        internal void Begin(HapticTouch touch)
        {
            TouchBegan?.Invoke(touch);
            touchBegins.Invoke(touch);
        }

        internal void End(HapticTouch touch)
        {
            TouchEnded?.Invoke(touch);
            touchEnds.Invoke(touch);
        }
    }
}
