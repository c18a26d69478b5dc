using UnityEngine;
#if ENABLE_INPUT_SYSTEM && PACINIAN_INPUT_SYSTEM
using UnityEngine.InputSystem;
#endif

namespace Pacinian.Samples
{
    /// <summary>Moves a hand to and fro over a ball, in place of a tracker: by the mouse while its button is down.</summary>
    [AddComponentMenu("Pacinian/Samples/Hand Over Ball")]
    public sealed class HandOverBall : MonoBehaviour
    {
        [SerializeField, Tooltip("What the hand is above.")] private Transform ball;
        [SerializeField, Tooltip("Of the palm above the ball's middle [m].")] private float height = 0.04f;
        [SerializeField, Tooltip("To either side [m].")] private float amplitude = 0.03f;
        [SerializeField, Tooltip("For once to and fro [s].")] private float period = 3f;

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

        /// <summary>Whether the mouse's left button is down, and where it is [pixels]: by either of Unity's input systems.</summary>
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
