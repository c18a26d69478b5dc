using System;
using UnityEngine;

namespace UnityEditor
{
    [AttributeUsage(AttributeTargets.Class)]
    public sealed class CustomEditor : Attribute
    {
        public CustomEditor(Type inspected, bool editorForChildClasses = false)
        {
        }
    }

    [AttributeUsage(AttributeTargets.Class)]
    public sealed class CanEditMultipleObjects : Attribute
    {
    }

    [AttributeUsage(AttributeTargets.Class)]
    public sealed class CustomPropertyDrawer : Attribute
    {
        public CustomPropertyDrawer(Type type)
        {
        }
    }

    public class Editor : ScriptableObject
    {
        public UnityEngine.Object target { get; set; }

        public UnityEngine.Object[] targets
        {
            get { return new[] { target }; }
        }

        public SerializedObject serializedObject { get; }

        public virtual void OnInspectorGUI()
        {
        }

        public virtual bool RequiresConstantRepaint()
        {
            return false;
        }

        public bool DrawDefaultInspector()
        {
            return false;
        }

        protected static void DrawPropertiesExcluding(SerializedObject thing, params string[] names)
        {
        }
    }

    public abstract class PropertyDrawer
    {
        public virtual void OnGUI(Rect position, SerializedProperty property, GUIContent label)
        {
        }

        public virtual float GetPropertyHeight(SerializedProperty property, GUIContent label)
        {
            return 0f;
        }
    }

    public sealed class SerializedObject
    {
        public SerializedObject(UnityEngine.Object thing)
        {
            targetObject = thing;
        }

        public UnityEngine.Object targetObject { get; private set; }

        public void Update()
        {
        }

        public bool ApplyModifiedProperties()
        {
            return false;
        }

        public SerializedProperty FindProperty(string name)
        {
            return new SerializedProperty();
        }
    }

    public sealed class SerializedProperty
    {
        internal SerializedProperty()
        {
        }

        public string stringValue { get; set; } = "";

        public float floatValue { get; set; }

        public bool hasMultipleDifferentValues { get; }

        public int enumValueIndex { get; set; }

        public bool isExpanded { get; set; }

        public SerializedProperty FindPropertyRelative(string name)
        {
            return new SerializedProperty();
        }
    }

    public enum MessageType
    {
        None,
        Info,
        Warning,
        Error,
    }

    public static class EditorGUILayout
    {
        public static void LabelField(string label, string text)
        {
        }

        public static void HelpBox(string message, MessageType type)
        {
        }

        public static bool PropertyField(SerializedProperty property)
        {
            return false;
        }

        /// <summary>The value to which the user moves the next slider; null: none. Not in Unity.</summary>
        public static float? Slid { get; set; }

        public static float Slider(string label, float value, float low, float high)
        {
            EditorGUI.Changed = Slid != null;
            return Slid ?? value;
        }

        public static int Popup(string label, int index, string[] names)
        {
            return index;
        }

        public static string TextField(string label, string text)
        {
            return text;
        }

        public static Vector2 BeginScrollView(Vector2 at)
        {
            return at;
        }

        public static void EndScrollView()
        {
        }

        public static void BeginHorizontal()
        {
        }

        public static void EndHorizontal()
        {
        }

        public static void SelectableLabel(string text, GUIStyle style, params GUILayoutOption[] options)
        {
        }

        public static void Space()
        {
        }
    }

    public static class EditorGUI
    {
        public static bool showMixedValue { get; set; }

        internal static bool Changed { get; set; }

        public static void BeginChangeCheck()
        {
            Changed = false;
        }

        public static bool EndChangeCheck()
        {
            return Changed;
        }

        public static bool PropertyField(Rect place, SerializedProperty property)
        {
            return false;
        }

        public static bool PropertyField(Rect place, SerializedProperty property, GUIContent label)
        {
            return false;
        }
    }

    public static class EditorGUIUtility
    {
        public static float singleLineHeight
        {
            get { return 18f; }
        }

        public static float standardVerticalSpacing
        {
            get { return 2f; }
        }
    }

    public static class EditorStyles
    {
        public static GUIStyle wordWrappedLabel
        {
            get { return new GUIStyle(); }
        }
    }
}
