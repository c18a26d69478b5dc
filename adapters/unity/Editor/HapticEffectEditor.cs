using System.Globalization;
using UnityEditor;

namespace Pacinian.Haptics.Editing
{
    /// <summary>An effect, and what is emitted for it.</summary>
    [CustomEditor(typeof(HapticEffect), true)]
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
            HapticEffect effect = (HapticEffect)target;
            serializedObject.Update();
            DrawPropertiesExcluding(serializedObject, effect.Strength == HapticStrength.Force ? "radiationPressure" : "force");
            serializedObject.ApplyModifiedProperties();
            if (EditorApplication.isPlaying)
            {
                EditorGUILayout.LabelField("Known to the server as", effect.WireName);
                EditorGUILayout.LabelField("Emitted", effect.Emitted.ToString("F1", CultureInfo.InvariantCulture) + " Pa");
                EditorGUILayout.LabelField("Felt", effect.RegionFelt.ToString());
            }
            if (effect.Problem.Length > 0)
            {
                EditorGUILayout.HelpBox(effect.Problem, MessageType.Warning);
            }
        }
    }
}
