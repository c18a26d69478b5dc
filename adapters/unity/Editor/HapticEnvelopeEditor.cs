using UnityEditor;
using UnityEngine;

namespace Pacinian.Haptics.Editing
{
    /// <summary>Inspector of an envelope, with only the fields of its kind.</summary>
    [CustomEditor(typeof(HapticEnvelope))]
    [CanEditMultipleObjects]
    internal sealed class HapticEnvelopeEditor : Editor
    {
        private static readonly string[][] Fields = // of each EnvelopeKind
        {
            new[] { "level" },
            new[] { "frequency", "low", "high" },
            new[] { "frequency", "low", "high", "duty" },
            new[] { "width", "period", "start", "rise", "low", "high" },
            new[] { "lowFrequency", "highFrequency", "low", "high", "seed" },
            new[] { "preset" },
            new[] { "clip", "samples", "rate", "loop", "mode" },
            new[] { "curve", "loop" },
        };

        /// <inheritdoc/>
        public override void OnInspectorGUI()
        {
            serializedObject.Update();
            SerializedProperty kind = serializedObject.FindProperty("kind");
            EditorGUILayout.PropertyField(kind);
            foreach (string field in kind.hasMultipleDifferentValues ? new string[0] : Fields[kind.enumValueIndex])
            {
                EditorGUILayout.PropertyField(serializedObject.FindProperty(field));
            }
            serializedObject.ApplyModifiedProperties();
            foreach (Object each in targets)
            {
                HapticEnvelope envelope = (HapticEnvelope)each;
                if (envelope.Problem.Length > 0)
                {
                    EditorGUILayout.HelpBox(each.name + ": " + envelope.Problem, MessageType.Warning);
                }
            }
        }
    }
}
