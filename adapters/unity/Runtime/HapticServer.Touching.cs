using System;

namespace Pacinian.Haptics
{
    /// <summary>Touches, with the effects of this game in place of their names.</summary>
    public sealed partial class HapticServer
    {
        /// <summary>A hand begins to feel an effect. Effects have this event, too.</summary>
        public event Action<HapticTouch> TouchBegan;

        /// <summary>A hand feels an effect still, where and as strongly as told, 60 times a second.</summary>
        public event Action<HapticTouch> TouchMoved;

        /// <summary>A hand feels an effect no more, as it was told last.</summary>
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

        /// <summary>False of an object that another program has put, or that is disabled now.</summary>
        private static bool Find(HandTouch touch, out HapticTouch made)
        {
            made = new HapticTouch
            {
                Effect = HapticEffect.Named(touch.Object),
                Hand = touch.Hand,
                Position = Frames.Back(ArrayOrigin.InWorld.Point(touch.Position)),
                Pressure = (float)touch.Pressure,
                Strength = (float)touch.Strength,
            };
            return made.Effect is object;
        }
    }
}
