using System;
using System.Collections.Generic;
using Pacinian.Wire;

namespace Pacinian
{
    /// <summary>
    /// Compares the touches of the newest state with those before, so that a lost state loses no end of a touch.
    /// Allocates nothing once the lists are long enough.
    /// </summary>
    internal sealed class TouchTracker
    {
        private readonly List<HandTouch> _now = new List<HandTouch>();
        private bool _ended;

        /// <summary>The present touches.</summary>
        public IReadOnlyList<HandTouch> Now
        {
            get { return _now; }
        }

        /// <summary>Reports touches that ended, began or moved. state: the newest one; null: all touches end.</summary>
        public void ReportChanges(State state, Action<HandTouch> began, Action<HandTouch> moved, Action<HandTouch> ended)
        {
            int count = state == null ? 0 : state.Touches.Count;
            for (int i = _now.Count - 1; i >= 0 && i < _now.Count; i--)
            {
                HandTouch old = _now[i];
                if (Find(state, count, old) < 0)
                {
                    _now.RemoveAt(i);
                    ended?.Invoke(old);
                }
            }
            for (int i = 0; i < count && !_ended; i++)
            {
                HandTouch touch = HandTouch.Of(state.Touches[i]);
                int known = Find(state.Touches[i]);
                if (known < 0)
                {
                    _now.Add(touch);
                    began?.Invoke(touch);
                }
                else
                {
                    _now[known] = touch;
                    moved?.Invoke(touch);
                }
            }
        }

        /// <summary>Forgets the touches, and reports none from now on. A handler of a touch may call it.</summary>
        public void End()
        {
            _now.Clear();
            _ended = true;
        }

        private static int Find(State state, int count, HandTouch touch)
        {
            for (int i = 0; i < count; i++)
            {
                if (touch.Same(state.Touches[i]))
                {
                    return i;
                }
            }
            return -1;
        }

        private int Find(TouchState state)
        {
            for (int i = 0; i < _now.Count; i++)
            {
                if (_now[i].Same(state))
                {
                    return i;
                }
            }
            return -1;
        }
    }
}
