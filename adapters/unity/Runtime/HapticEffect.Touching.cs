using System;
using UnityEngine;

namespace Pacinian.Haptics
{
    /// <summary>Hands that feel an effect.</summary>
    public abstract partial class HapticEffect
    {
        [SerializeField, Tooltip("A hand begins to feel it.")]
        private HapticTouchEvent touchBegins = new HapticTouchEvent();
        [SerializeField, Tooltip("A hand feels it no more.")]
        private HapticTouchEvent touchEnds = new HapticTouchEvent();

        /// <summary>A hand begins to feel it.</summary>
        public event Action<HapticTouch> TouchBegan;

        /// <summary>A hand feels it no more, as it was told last.</summary>
        public event Action<HapticTouch> TouchEnded;

        /// <summary>The one that the server knows by that name; null if there is none.</summary>
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
