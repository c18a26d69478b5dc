using UnityEditor;
using UnityEngine;

namespace Pacinian.Haptics.Editing
{
    /// <summary>Storing where the array stands.</summary>
    [CustomEditor(typeof(ArrayOrigin))]
    internal sealed class ArrayOriginEditor : Editor
    {
        private string _problem = "";

        /// <inheritdoc/>
        public override void OnInspectorGUI()
        {
            DrawDefaultInspector();
            ArrayOrigin origin = (ArrayOrigin)target;
            EditorGUILayout.LabelField("Stored in", origin.Path);
            EditorGUILayout.BeginHorizontal();
            if (GUILayout.Button("Store"))
            {
                _problem = origin.Save();
            }
            if (GUILayout.Button("As stored"))
            {
                Undo.RecordObject(origin.transform, "Array as stored");
                _problem = origin.Load();
            }
            EditorGUILayout.EndHorizontal();
            if (_problem.Length > 0)
            {
                EditorGUILayout.HelpBox(_problem, MessageType.Warning);
            }
        }
    }
}
