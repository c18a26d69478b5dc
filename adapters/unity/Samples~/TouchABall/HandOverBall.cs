using Pacinian.Haptics;
using UnityEngine;

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
            if (MouseInput.Held(out mouse))
            {
                side = 0.15f * mouse.x;
                forward = 0.15f * mouse.y - 0.03f;
            }
            transform.position = ball.position + new Vector3(side, height, forward);
        }
    }
}
