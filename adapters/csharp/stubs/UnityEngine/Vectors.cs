using System;

namespace UnityEngine
{
    public struct Vector2
    {
        public float x, y;

        public Vector2(float x, float y)
        {
            this.x = x;
            this.y = y;
        }

        public static Vector2 zero
        {
            get { return new Vector2(); }
        }
    }

    public struct Vector3 : IEquatable<Vector3>
    {
        public float x, y, z;

        public Vector3(float x, float y, float z)
        {
            this.x = x;
            this.y = y;
            this.z = z;
        }

        public static Vector3 zero
        {
            get { return new Vector3(); }
        }

        public static Vector3 one
        {
            get { return new Vector3(1f, 1f, 1f); }
        }

        public static Vector3 up
        {
            get { return new Vector3(0f, 1f, 0f); }
        }

        public float magnitude
        {
            get { return (float)Math.Sqrt(x * x + y * y + z * z); }
        }

        public float this[int index]
        {
            get { return index == 0 ? x : index == 1 ? y : z; }
        }

        public static Vector3 operator +(Vector3 a, Vector3 b)
        {
            return new Vector3(a.x + b.x, a.y + b.y, a.z + b.z);
        }

        public static Vector3 operator -(Vector3 a, Vector3 b)
        {
            return new Vector3(a.x - b.x, a.y - b.y, a.z - b.z);
        }

        public static Vector3 operator *(float s, Vector3 a)
        {
            return new Vector3(s * a.x, s * a.y, s * a.z);
        }

        public static bool operator ==(Vector3 a, Vector3 b)
        {
            return (a - b).magnitude < 1e-5f;
        }

        public static bool operator !=(Vector3 a, Vector3 b)
        {
            return !(a == b);
        }

        public static Vector3 Scale(Vector3 a, Vector3 b)
        {
            return new Vector3(a.x * b.x, a.y * b.y, a.z * b.z);
        }

        public bool Equals(Vector3 other)
        {
            return x.Equals(other.x) && y.Equals(other.y) && z.Equals(other.z);
        }

        public override bool Equals(object other)
        {
            return other is Vector3 && Equals((Vector3)other);
        }

        public override int GetHashCode()
        {
            return x.GetHashCode() ^ (y.GetHashCode() << 2) ^ (z.GetHashCode() >> 2);
        }
    }

    public struct Color
    {
        public float r, g, b, a;

        public Color(float r, float g, float b)
        {
            this.r = r;
            this.g = g;
            this.b = b;
            a = 1f;
        }

        public static Color green
        {
            get { return new Color(0f, 1f, 0f); }
        }

        public static Color yellow
        {
            get { return new Color(1f, 0.92f, 0.016f); }
        }

        public static Color blue
        {
            get { return new Color(0f, 0f, 1f); }
        }

        public static Color red
        {
            get { return new Color(1f, 0f, 0f); }
        }

        public static Color white
        {
            get { return new Color(1f, 1f, 1f); }
        }

        public static Color Lerp(Color a, Color b, float t)
        {
            t = Mathf.Clamp01(t);
            return new Color(a.r + t * (b.r - a.r), a.g + t * (b.g - a.g), a.b + t * (b.b - a.b));
        }
    }

    public static class Mathf
    {
        public const float PI = (float)Math.PI;

        public static float Clamp(float value, float low, float high)
        {
            return value < low ? low : value > high ? high : value;
        }

        public static float Abs(float value)
        {
            return Math.Abs(value);
        }

        public static float Clamp01(float value)
        {
            return Clamp(value, 0f, 1f);
        }

        public static float Min(float a, float b)
        {
            return Math.Min(a, b);
        }

        public static float Max(float a, float b)
        {
            return a > b ? a : b;
        }

        public static float Sin(float angle)
        {
            return (float)Math.Sin(angle);
        }

        public static float Cos(float angle)
        {
            return (float)Math.Cos(angle);
        }
    }

    public struct Matrix4x4
    {
        private Vector3 _position, _scale;
        private Quaternion _rotation;

        public static Matrix4x4 identity
        {
            get { return TRS(Vector3.zero, Quaternion.identity, Vector3.one); }
        }

        public static Matrix4x4 TRS(Vector3 position, Quaternion rotation, Vector3 scale)
        {
            return new Matrix4x4 { _position = position, _rotation = rotation, _scale = scale };
        }

        public Vector3 MultiplyPoint(Vector3 point)
        {
            return _position + _rotation * Vector3.Scale(_scale, point);
        }
    }

    public struct Pose
    {
        public Vector3 position;
        public Quaternion rotation;
    }
}
