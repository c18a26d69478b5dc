using UnityEngine;

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
#if ENABLE_LEGACY_INPUT_MANAGER
            if (Input.GetMouseButton(0))
            {
                side = 0.3f * (Input.mousePosition.x / Screen.width - 0.5f);
                forward = 0.3f * (Input.mousePosition.y / Screen.height - 0.5f) - 0.03f;
            }
#endif
            transform.position = ball.position + new Vector3(side, height, forward);
        }
    }
}
