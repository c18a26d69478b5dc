using System.Globalization;
using UnityEditor;
using UnityEngine;

namespace Pacinian.Haptics.Editing
{
    /// <summary>Touching the known points one by one.</summary>
    [CustomEditor(typeof(ArrayAlignment))]
    internal sealed class ArrayAlignmentEditor : Editor
    {
        /// <inheritdoc/>
        public override bool RequiresConstantRepaint()
        {
            return EditorApplication.isPlaying;
        }

        /// <inheritdoc/>
        public override void OnInspectorGUI()
        {
            DrawDefaultInspector();
            ArrayAlignment alignment = (ArrayAlignment)target;
            EditorGUILayout.LabelField("Touched", alignment.Touched + " of " + alignment.KnownPoints.Length);
            if (alignment.Residual > 0f)
            {
                EditorGUILayout.LabelField("Last alignment", Told(alignment));
            }
            GUI.enabled = EditorApplication.isPlaying;
            if (GUILayout.Button("Corners of the server's array"))
            {
                alignment.UseCorners();
            }
            if (GUILayout.Button("The pointer touches point " + (alignment.Touched + 1)))
            {
                alignment.Touch();
            }
            if (GUILayout.Button("Begin again"))
            {
                alignment.Begin();
            }
            GUI.enabled = true;
            if (alignment.Problem.Length > 0)
            {
                EditorGUILayout.HelpBox(alignment.Problem, MessageType.Warning);
            }
        }

        private static string Told(ArrayAlignment alignment)
        {
            return string.Format(
                CultureInfo.InvariantCulture, "{0:F1} mm, at most {1:F1} mm", 1e3f * alignment.Residual, 1e3f * alignment.Worst);
        }
    }
}
