using System.Globalization;
using UnityEditor;
using UnityEngine;

namespace Pacinian.Haptics.Editing
{
    /// <summary>Inspector of one or several effects, with the pressure that is emitted for them.</summary>
    [CustomEditor(typeof(HapticEffect), true)]
    [CanEditMultipleObjects]
    internal sealed class HapticEffectEditor : Editor
    {
        /// <inheritdoc/>
        public override bool RequiresConstantRepaint()
        {
            return EditorApplication.isPlaying;
        }

        /// <inheritdoc/>
        public override void OnInspectorGUI()
        {
            serializedObject.Update();
            SerializedProperty strength = serializedObject.FindProperty("strength");
            bool alike = !strength.hasMultipleDifferentValues, force = strength.enumValueIndex == (int)HapticStrength.Force;
            DrawPropertiesExcluding(serializedObject, "m_Script", !alike ? "" : force ? "radiationPressure" : "force");
            if (!alike || !force)
            {
                Slide(serializedObject.FindProperty("radiationPressure"), PacinianSettings.Current.FullPressure);
            }
            serializedObject.ApplyModifiedProperties();
            foreach (Object each in targets)
            {
                Tell((HapticEffect)each, targets.Length > 1 ? each.name + ": " : "");
            }
        }

        /// <summary>Draws a slider for the pressure, from 0 to 1, with pascals beside it.</summary>
        internal static void Slide(SerializedProperty pressure, float full)
        {
            EditorGUI.showMixedValue = pressure.hasMultipleDifferentValues;
            EditorGUI.BeginChangeCheck();
            float share = EditorGUILayout.Slider(Label(pressure.floatValue, full), Mathf.Clamp01(pressure.floatValue / full), 0f, 1f);
            if (EditorGUI.EndChangeCheck())
            {
                pressure.floatValue = share * full;
            }
            EditorGUI.showMixedValue = false;
        }

        /// <summary>Returns a label such as: Relative strength (8.0 of 20 Pa).</summary>
        internal static string Label(float pressure, float full)
        {
            return string.Format(CultureInfo.InvariantCulture, "Relative strength ({0:F1} of {1:G4} Pa)", pressure, full);
        }

        private static void Tell(HapticEffect effect, string whose)
        {
            if (EditorApplication.isPlaying && whose.Length == 0)
            {
                EditorGUILayout.LabelField("Known to the server as", effect.WireName);
                EditorGUILayout.LabelField("Emitted", effect.Emitted.ToString("F1", CultureInfo.InvariantCulture) + " Pa");
                EditorGUILayout.LabelField("Felt", effect.RegionFelt.ToString());
            }
            if (effect.Problem.Length > 0)
            {
                EditorGUILayout.HelpBox(whose + effect.Problem, MessageType.Warning);
            }
        }
    }
}
