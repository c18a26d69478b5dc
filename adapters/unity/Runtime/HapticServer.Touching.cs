using System;

namespace Pacinian.Haptics
{
    /// <summary>Touch events, with this game's effects in place of their names.</summary>
    public sealed partial class HapticServer
    {
        /// <summary>A hand begins to feel an effect. Each effect has this event, too.</summary>
        public event Action<HapticTouch> TouchBegan;

        /// <summary>A hand still feels an effect: its position and strength, 60 times a second.</summary>
        public event Action<HapticTouch> TouchMoved;

        /// <summary>A hand no longer feels an effect. The argument is the last report of the touch.</summary>
        public event Action<HapticTouch> TouchEnded;

        private void OnTouchBegan(HandTouch touch)
        {
            HapticTouch made;
            if (Find(touch, out made))
            {
                TouchBegan?.Invoke(made);
                made.Effect.Begin(made);
            }
        }

        private void OnTouchMoved(HandTouch touch)
        {
            HapticTouch made;
            if (TouchMoved != null && Find(touch, out made))
            {
                TouchMoved(made);
            }
        }

        private void OnTouchEnded(HandTouch touch)
        {
            HapticTouch made;
            if (Find(touch, out made))
            {
                TouchEnded?.Invoke(made);
                made.Effect.End(made);
            }
        }

        /// <summary>Returns false if another client has put the object, or if it is disabled now.</summary>
        private static bool Find(HandTouch touch, out HapticTouch made)
        {
            made = new HapticTouch
            {
                Effect = HapticEffect.Named(touch.Object),
                Hand = touch.Hand,
                Position = WireSpace.ToUnity(ArrayOrigin.InWorld.Point(touch.Position)),
                Pressure = (float)touch.Pressure,
                Strength = (float)touch.Strength,
            };
            return made.Effect is object;
        }
    }
}
