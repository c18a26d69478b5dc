using System;
using System.Collections.Generic;
using System.Reflection;
using System.Runtime.CompilerServices;
using UnityEngine;

namespace UnityEditor
{
    [AttributeUsage(AttributeTargets.Class)]
    public sealed class InitializeOnLoadAttribute : Attribute
    {
    }

    [AttributeUsage(AttributeTargets.Method)]
    public sealed class MenuItem : Attribute
    {
        public MenuItem(string name)
        {
        }

        public MenuItem(string name, bool validates, int priority)
        {
        }
    }

    public sealed class MenuCommand
    {
        public MenuCommand(UnityEngine.Object context)
        {
            this.context = context;
        }

        public UnityEngine.Object context { get; private set; }
    }

    public enum PlayModeStateChange
    {
        EnteredEditMode,
        ExitingEditMode,
        EnteredPlayMode,
        ExitingPlayMode,
    }

    public enum PauseState
    {
        Paused,
        Unpaused,
    }

    public static class AssemblyReloadEvents
    {
        public delegate void AssemblyReloadCallback();

        public static event AssemblyReloadCallback beforeAssemblyReload;

        /// <summary>Not in Unity.</summary>
        public static void Raise()
        {
            beforeAssemblyReload?.Invoke();
        }
    }

    public static class EditorApplication
    {
        public delegate void CallbackFunction();

        public static event Action<PlayModeStateChange> playModeStateChanged;

        public static event Action quitting;

        public static event Action<PauseState> pauseStateChanged;

        public static CallbackFunction update { get; set; }

        public static bool isPaused { get; private set; }

        public static double timeSinceStartup
        {
            get { return Time.realtimeSinceStartupAsDouble; }
        }

        public static bool isPlaying
        {
            get { return Engine.Playing; }
        }

        /// <summary>Not in Unity.</summary>
        public static void Raise(PlayModeStateChange change)
        {
            playModeStateChanged?.Invoke(change);
        }

        /// <summary>Pauses the editor, or continues. Not in Unity.</summary>
        public static void Pause(bool pauses)
        {
            isPaused = pauses;
            pauseStateChanged?.Invoke(pauses ? PauseState.Paused : PauseState.Unpaused);
        }

        /// <summary>Loads scripts. Not in Unity.</summary>
        public static void Load(Assembly scripts)
        {
            foreach (Type type in scripts.GetTypes())
            {
                if (type.IsDefined(typeof(InitializeOnLoadAttribute), false))
                {
                    RuntimeHelpers.RunClassConstructor(type.TypeHandle);
                }
            }
        }

        /// <summary>Not in Unity.</summary>
        public static void Quit()
        {
            quitting?.Invoke();
        }
    }

    public static class SessionState
    {
        private static readonly Dictionary<string, string> Values = new Dictionary<string, string>();

        public static string GetString(string key, string otherwise)
        {
            string value;
            return Values.TryGetValue(key, out value) ? value : otherwise;
        }

        public static void SetString(string key, string value)
        {
            Values[key] = value;
        }
    }

    public static class EditorPrefs
    {
        private static readonly Dictionary<string, string> Values = new Dictionary<string, string>();

        public static string GetString(string key, string otherwise)
        {
            string value;
            return Values.TryGetValue(key, out value) ? value : otherwise;
        }

        public static void SetString(string key, string value)
        {
            Values[key] = value;
        }
    }

    public static class EditorUtility
    {
        public static string OpenFilePanel(string title, string folder, string extension)
        {
            return "";
        }
    }

    public enum SettingsScope
    {
        User,
        Project,
    }

    [AttributeUsage(AttributeTargets.Method)]
    public sealed class SettingsProviderAttribute : Attribute
    {
    }

    public class SettingsProvider
    {
        public SettingsProvider(string path, SettingsScope scope, IEnumerable<string> keywords = null)
        {
            settingsPath = path;
        }

        public string settingsPath { get; private set; }

        public string label { get; set; }

        public IEnumerable<string> keywords { get; set; }

        public Action<string> guiHandler { get; set; }
    }

    public static class AssetDatabase
    {
        /// <summary>The assets by path. Not in Unity.</summary>
        public static readonly Dictionary<string, UnityEngine.Object> Assets = new Dictionary<string, UnityEngine.Object>();

        public static bool Contains(UnityEngine.Object thing)
        {
            return Assets.ContainsValue(thing);
        }

        public static bool IsValidFolder(string path)
        {
            return Assets.ContainsKey(path);
        }

        public static string CreateFolder(string parent, string name)
        {
            Assets[parent + "/" + name] = new UnityEngine.Object();
            return "";
        }

        public static void CreateAsset(UnityEngine.Object thing, string path)
        {
            Assets[path] = thing;
        }

        public static void Refresh()
        {
        }
    }

    public static class Selection
    {
        public static UnityEngine.Object activeObject { get; set; }
    }

    public static class Undo
    {
        public static void RegisterCreatedObjectUndo(UnityEngine.Object thing, string name)
        {
        }

        public static void RecordObject(UnityEngine.Object thing, string name)
        {
        }
    }

    public static class GameObjectUtility
    {
        public static void SetParentAndAlign(GameObject child, GameObject parent)
        {
            if (parent != null)
            {
                child.transform.SetParent(parent.transform, false);
            }
        }
    }

    public class EditorWindow : ScriptableObject
    {
        public static T GetWindow<T>(string title)
            where T : EditorWindow, new()
        {
            return new T();
        }

        public void Repaint()
        {
        }
    }
}
