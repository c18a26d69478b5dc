using System;
using System.Collections.Generic;
using System.Diagnostics;

namespace UnityEngine
{
    public static class Time
    {
        public static double realtimeSinceStartupAsDouble
        {
            get { return Stopwatch.GetTimestamp() / (double)Stopwatch.Frequency; }
        }

        public static float time
        {
            get { return (float)realtimeSinceStartupAsDouble; }
        }
    }

    public static class Application
    {
        public static string productName { get; } = "game";

        public static string version { get; } = "1.0";

        public static string persistentDataPath { get; } = ".";

        public static string dataPath { get; } = ".";

        public static string streamingAssetsPath { get; private set; } = "StreamingAssets";

        /// <summary>Sets the folder of streaming assets. Not in Unity.</summary>
        public static void SetStreamingAssetsPath(string folder)
        {
            streamingAssetsPath = folder;
        }
    }

    public static class Resources
    {
        /// <summary>The assets in folders Resources, by name. Not in Unity.</summary>
        public static readonly Dictionary<string, Object> Assets = new Dictionary<string, Object>();

        public static T Load<T>(string path)
            where T : Object
        {
            Object found;
            return Assets.TryGetValue(path, out found) ? (T)found : null;
        }
    }

    public static class Debug
    {
        /// <summary>The logged messages. Not in Unity.</summary>
        public static readonly List<string> Said = new List<string>();

        public static void Log(object message, Object context = null)
        {
            Said.Add(message.ToString());
        }

        /// <summary>Called on other threads, too.</summary>
        public static void LogError(object message, Object context = null)
        {
            lock (Said)
            {
                Said.Add(message.ToString());
            }
        }

        public static void LogWarning(object message, Object context = null)
        {
            Said.Add(message.ToString());
        }
    }

    public static class Gizmos
    {
        /// <summary>The centres of the drawn spheres. Not in Unity.</summary>
        public static readonly List<Vector3> Spheres = new List<Vector3>();

        /// <summary>
        /// Points of drawn outlines: of spheres, the middle and a point above it; of boxes, two corners. Not in Unity.
        /// </summary>
        public static readonly List<Vector3> Lines = new List<Vector3>();

        public static Color color { get; set; }

        public static Matrix4x4 matrix { get; set; } = Matrix4x4.identity;

        public static void DrawSphere(Vector3 centre, float radius)
        {
            Spheres.Add(centre);
        }

        public static void DrawWireSphere(Vector3 centre, float radius)
        {
            DrawLine(centre, centre + radius * Vector3.up);
        }

        public static void DrawWireCube(Vector3 centre, Vector3 size)
        {
            DrawLine(centre - 0.5f * size, centre + 0.5f * size);
        }

        public static void DrawLine(Vector3 from, Vector3 to)
        {
            Lines.Add(matrix.MultiplyPoint(from));
            Lines.Add(matrix.MultiplyPoint(to));
        }
    }

    public static class SubsystemManager
    {
        public static void GetSubsystems<T>(List<T> found)
        {
            found.Clear();
        }
    }

    public static class Input
    {
        public static Vector3 mousePosition
        {
            get { return Given; }
        }

        /// <summary>The mouse's position. Not in Unity.</summary>
        public static Vector3 Given { get; set; }

        /// <summary>Whether the left button is down. Not in Unity.</summary>
        public static bool Held { get; set; }

        public static bool GetMouseButton(int button)
        {
            return Held && button == 0;
        }
    }

    public static class Screen
    {
        public static int width { get; } = 1920;

        public static int height { get; } = 1080;
    }
}
