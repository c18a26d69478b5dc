using UnityEditor;
using UnityEngine;

namespace Pacinian.Haptics.Editing
{
    /// <summary>Inspector of a technique, with only the fields of its kind.</summary>
    [CustomPropertyDrawer(typeof(HapticTechnique))]
    internal sealed class TechniqueDrawer : PropertyDrawer
    {
        private static readonly string[][] Fields = // of each TechniqueKind
        {
            new string[0], new string[0], new[] { "frequency", "depth" }, new[] { "frequency", "outline" },
            new[] { "frequency", "amplitude", "angle" },
        };

        /// <inheritdoc/>
        public override void OnGUI(Rect position, SerializedProperty property, GUIContent label)
        {
            float step = EditorGUIUtility.singleLineHeight + EditorGUIUtility.standardVerticalSpacing;
            Rect line = new Rect(position.x, position.y, position.width, EditorGUIUtility.singleLineHeight);
            EditorGUI.PropertyField(line, property.FindPropertyRelative("kind"), label);
            foreach (string field in Shown(property))
            {
                line.y += step;
                EditorGUI.PropertyField(line, property.FindPropertyRelative(field));
            }
        }

        /// <inheritdoc/>
        public override float GetPropertyHeight(SerializedProperty property, GUIContent label)
        {
            float step = EditorGUIUtility.singleLineHeight + EditorGUIUtility.standardVerticalSpacing;
            return step * (1 + Shown(property).Length);
        }

        private static string[] Shown(SerializedProperty property)
        {
            return Fields[property.FindPropertyRelative("kind").enumValueIndex];
        }
    }
}
