using UnityEngine;
#if ENABLE_INPUT_SYSTEM && PACINIAN_INPUT_SYSTEM
using UnityEngine.InputSystem;
#endif

namespace Pacinian.Haptics
{
    /// <summary>The mouse, with either of Unity's input systems.</summary>
    public static class MouseInput
    {
        /// <summary>
        /// Returns whether the left button is down. place: of the mouse in the window, from (-1, -1) at the lower left to
        /// (1, 1) at the upper right; beyond the window, its edge.
        /// </summary>
        public static bool Held(out Vector2 place)
        {
            Vector2 pixels = Vector2.zero;
            bool held = false;
#if ENABLE_INPUT_SYSTEM && PACINIAN_INPUT_SYSTEM
            Mouse mouse = Mouse.current;
            if (mouse != null)
            {
                pixels = mouse.position.ReadValue();
                held = mouse.leftButton.isPressed;
            }
#elif ENABLE_LEGACY_INPUT_MANAGER
            pixels = new Vector2(Input.mousePosition.x, Input.mousePosition.y);
            held = Input.GetMouseButton(0);
#endif
            place = new Vector2(FromMiddle(pixels.x, Screen.width), FromMiddle(pixels.y, Screen.height));
            return held;
        }

        private static float FromMiddle(float pixels, int size)
        {
            return Mathf.Clamp(2f * pixels / size - 1f, -1f, 1f);
        }
    }
}
