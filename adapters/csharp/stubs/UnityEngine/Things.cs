using System;

namespace UnityEngine
{
    public sealed class Mesh : Object
    {
        public Vector3[] vertices { get; set; } = new Vector3[0];

        public int[] triangles { get; set; } = new int[0];

        public bool isReadable { get; set; } = true;
    }

    public sealed class MeshFilter : Component
    {
        public Mesh sharedMesh { get; set; }
    }

    public sealed class MeshRenderer : Component
    {
    }

    public class Collider : Component
    {
        public bool enabled { get; set; } = true;
    }

    public sealed class BoxCollider : Collider
    {
        public Vector3 center { get; set; }

        public Vector3 size { get; set; } = Vector3.one;
    }

    public sealed class SphereCollider : Collider
    {
        public Vector3 center { get; set; }

        public float radius { get; set; } = 0.5f;
    }

    public sealed class CapsuleCollider : Collider
    {
        public Vector3 center { get; set; }

        public float radius { get; set; } = 0.5f;

        public float height { get; set; } = 2f;

        public int direction { get; set; } = 1;
    }

    public sealed class MeshCollider : Collider
    {
        public Mesh sharedMesh { get; set; }
    }

    public sealed class CharacterController : Collider
    {
    }

    public sealed class Camera : Behaviour
    {
        public static Camera main { get; set; }
    }

    public sealed class AudioClip : Object
    {
        private float[] _data = new float[0];

        public int samples
        {
            get { return _data.Length / channels; }
        }

        public int channels { get; private set; }

        public int frequency { get; private set; }

        public static AudioClip Create(string name, int samples, int channels, int frequency, bool stream)
        {
            return new AudioClip
            {
                name = name, channels = channels, frequency = frequency, _data = new float[samples * channels],
            };
        }

        public bool SetData(float[] data, int offset)
        {
            Array.Copy(data, _data, data.Length);
            return true;
        }

        public bool GetData(float[] data, int offset)
        {
            Array.Copy(_data, data, data.Length);
            return true;
        }
    }

    public sealed class Light : Behaviour
    {
        public float intensity { get; set; }
    }
}
