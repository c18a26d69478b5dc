using UnityEngine;
#if ENABLE_INPUT_SYSTEM && PACINIAN_INPUT_SYSTEM
using UnityEngine.InputSystem;
#endif

namespace Pacinian.Samples
{
    /// <summary>Replaces a tracker: moves a hand to and fro over a ball, or by the mouse while its button is down.</summary>
    [AddComponentMenu("Pacinian/Samples/Hand Over Ball")]
    public sealed class HandOverBall : MonoBehaviour
    {
        [SerializeField, Tooltip("The ball below the hand.")] private Transform ball;
        [SerializeField, Tooltip("Height of the palm above the ball's middle [m].")] private float height = 0.04f;
        [SerializeField, Tooltip("Amplitude to either side [m].")] private float amplitude = 0.03f;
        [SerializeField, Tooltip("Time of a movement to and fro [s].")] private float period = 3f;

        private void Update()
        {
            float side = amplitude * Mathf.Sin(2f * Mathf.PI * Time.time / period), forward = -0.03f;
            Vector2 mouse;
            if (Pressed(out mouse))
            {
                side = 0.3f * (mouse.x / Screen.width - 0.5f);
                forward = 0.3f * (mouse.y / Screen.height - 0.5f) - 0.03f;
            }
            transform.position = ball.position + new Vector3(side, height, forward);
        }

        /// <summary>
        /// Returns whether the mouse's left button is down; writes its position [pixels]. Supports both of Unity's
        /// input systems.
        /// </summary>
        private static bool Pressed(out Vector2 mouse)
        {
            mouse = Vector2.zero;
#if ENABLE_INPUT_SYSTEM && PACINIAN_INPUT_SYSTEM
            mouse = Mouse.current == null ? mouse : Mouse.current.position.ReadValue();
            return Mouse.current != null && Mouse.current.leftButton.isPressed;
#elif ENABLE_LEGACY_INPUT_MANAGER
            mouse = new Vector2(Input.mousePosition.x, Input.mousePosition.y);
            return Input.GetMouseButton(0);
#else
            return false;
#endif
        }
    }
}
