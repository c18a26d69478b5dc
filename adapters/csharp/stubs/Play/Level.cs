using Pacinian.Haptics;
using UnityEngine;

namespace Pacinian.Tests
{
    /// <summary>A scene with a moved and rotated array, a ball above it, a point, an open hand and a head.</summary>
    internal sealed class Level
    {
        /// <summary>The height of the ball's middle above the array [m].</summary>
        public const float Height = 0.175f;

        public readonly HapticServer Server;
        public readonly HapticVolume Ball;
        public readonly HapticPoint Point;
        public readonly HapticEnvelope Hum;
        public readonly EmissionView View;
        public readonly GameObject Array, Hand, Head;

        /// <summary>file: the connection file. lease: [s]; 0: the server's.</summary>
        public Level(string file, float lease)
        {
            GameObject rig = new GameObject("rig");
            rig.SetActive(false);
            Server = rig.AddComponent<HapticServer>();
            Server.ConnectionFile = file;
            Server.Lease = lease;
            Array = new GameObject("array");
            Array.transform.SetParent(rig.transform, false);
            Array.transform.localPosition = new Vector3(1f, 0.8f, 2f);
            Array.transform.localRotation = Quaternion.AngleAxis(40f, new Vector3(0.2f, 1f, 0.1f));
            Array.AddComponent<ArrayOrigin>();
            View = Array.AddComponent<EmissionView>();

            Hum = ScriptableObject.CreateInstance<HapticEnvelope>();
            GameObject ball = Above("ball", new Vector3(0f, Height, 0f));
            ball.transform.localScale = new Vector3(0.06f, 0.06f, 0.06f);
            ball.AddComponent<SphereCollider>();
            Ball = ball.AddComponent<HapticVolume>();
            Ball.Envelope = Hum;
            Point = Above("point", new Vector3(0f, 0.196f, -0.07f)).AddComponent<HapticPoint>();
            Point.PlayOnEnable = false;
            Point.Duration = 1f;

            Hand = Above("hand", Vector3.zero);
            Hand.AddComponent<HapticHand>().Source = HapticHandSource.Open;
            Head = Above("head", new Vector3(0f, 0.6f, -0.4f));
            Head.AddComponent<QuietZone>();
            Wave(0.0);
            rig.SetActive(true);
        }

        /// <summary>Moves the hand to and fro over the ball. time: [s].</summary>
        public void Wave(double time)
        {
            float side = 0.02f * Mathf.Sin(6.2831853f * (float)(time % 1.0));
            Hand.transform.localPosition = new Vector3(side, Height + 0.04f, -0.03f);
        }

        private GameObject Above(string name, Vector3 place)
        {
            GameObject made = new GameObject(name);
            made.transform.SetParent(Array.transform, false);
            made.transform.localPosition = place;
            return made;
        }
    }
}
