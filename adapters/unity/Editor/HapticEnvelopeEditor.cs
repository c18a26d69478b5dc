using UnityEditor;

namespace Pacinian.Haptics.Editing
{
    /// <summary>Of an envelope only what its kind has.</summary>
    [CustomEditor(typeof(HapticEnvelope))]
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
        };

        /// <inheritdoc/>
        public override void OnInspectorGUI()
        {
            serializedObject.Update();
            SerializedProperty kind = serializedObject.FindProperty("kind");
            EditorGUILayout.PropertyField(kind);
            foreach (string field in Fields[kind.enumValueIndex])
            {
                EditorGUILayout.PropertyField(serializedObject.FindProperty(field));
            }
            serializedObject.ApplyModifiedProperties();
            HapticEnvelope envelope = (HapticEnvelope)target;
            if (envelope.Problem.Length > 0)
            {
                EditorGUILayout.HelpBox(envelope.Problem, MessageType.Warning);
            }
        }
    }
}
