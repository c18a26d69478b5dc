using System;

namespace UnityEngine
{
    public sealed class Mesh : Object
    {
        public Vector3[] vertices { get; set; } = new Vector3[0];

        public int[] triangles { get; set; } = new int[0];

        public bool isReadable { get; } = true;
    }

    public sealed class MeshFilter : Component
    {
        public Mesh sharedMesh { get; set; }
    }

    public sealed class Material : Object
    {
    }

    public class Renderer : Component
    {
        public Material sharedMaterial { get; set; }
    }

    public sealed class MeshRenderer : Renderer
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
        public static Camera main { get; internal set; }
    }

    public struct Keyframe
    {
        public Keyframe(float time, float value)
        {
            this.time = time;
            this.value = value;
        }

        public float time { get; set; }

        public float value { get; set; }
    }

    /// <summary>Linear between keys.</summary>
    public sealed class AnimationCurve
    {
        private readonly Keyframe[] _keys;

        public AnimationCurve(params Keyframe[] keys)
        {
            _keys = keys;
        }

        public int length
        {
            get { return _keys.Length; }
        }

        public Keyframe this[int index]
        {
            get { return _keys[index]; }
        }

        public static AnimationCurve Linear(float timeStart, float valueStart, float timeEnd, float valueEnd)
        {
            return new AnimationCurve(new Keyframe(timeStart, valueStart), new Keyframe(timeEnd, valueEnd));
        }

        public float Evaluate(float time)
        {
            int next = Array.FindIndex(_keys, key => key.time > time);
            if (next <= 0)
            {
                return _keys[next < 0 ? _keys.Length - 1 : 0].value;
            }
            Keyframe a = _keys[next - 1], b = _keys[next];
            return a.value + (time - a.time) / (b.time - a.time) * (b.value - a.value);
        }
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
