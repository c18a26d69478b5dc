using System.Globalization;
using UnityEditor;
using UnityEngine;

namespace Pacinian.Haptics.Editing
{
    /// <summary>Inspector of an Array Origin: aligns it by touching known points one by one, and stores the result.</summary>
    [CustomEditor(typeof(ArrayOrigin))]
    internal sealed class ArrayOriginEditor : Editor
    {
        private string _problem = "";

        /// <inheritdoc/>
        public override bool RequiresConstantRepaint()
        {
            return EditorApplication.isPlaying;
        }

        /// <inheritdoc/>
        public override void OnInspectorGUI()
        {
            DrawDefaultInspector();
            ArrayOrigin origin = (ArrayOrigin)target;
            if (origin.Residual > 0f)
            {
                EditorGUILayout.LabelField("Last alignment", Told(origin));
            }
            EditorGUILayout.LabelField("Kept in", origin.Path);
            EditorGUILayout.BeginHorizontal();
            if (GUILayout.Button("Save"))
            {
                origin.SaveCalibration(out _problem);
            }
            if (GUILayout.Button("Load"))
            {
                Undo.RecordObject(origin.transform, "Array as kept");
                origin.LoadCalibration(out _problem);
            }
            if (GUILayout.Button("Forget"))
            {
                origin.ForgetCalibration();
            }
            EditorGUILayout.EndHorizontal();
            GUI.enabled = EditorApplication.isPlaying;
            Align(origin);
            GUI.enabled = true;
            if (_problem.Length > 0)
            {
                EditorGUILayout.HelpBox(_problem, MessageType.Warning);
            }
        }

        private void Align(ArrayOrigin origin)
        {
            Vector3 next;
            if (GUILayout.Button("Begin to align"))
            {
                _problem = origin.BeginAlignment() ? "" : "no points are known: give some, or connect a server";
            }
            if (origin.GetNextPoint(out next))
            {
                EditorGUILayout.LabelField("Touch next", next.ToString() + " m, with an index finger");
                Vector3 tip;
                if (GUILayout.Button("It touches point " + (origin.Touched + 1)) && Touching(out tip))
                {
                    origin.TouchPoint(tip);
                }
            }
            if (origin.Touched >= 3 && GUILayout.Button("Finish"))
            {
                origin.FinishAlignment(out _problem);
            }
        }

        /// <summary>Returns whether a hand is tracked; writes the tip of the first tracked hand's index finger.</summary>
        private bool Touching(out Vector3 tip)
        {
            const int Tip = 10;
            foreach (HapticHand hand in HapticHand.All)
            {
                if (hand.Tracked)
                {
                    tip = hand.Joint(Tip);
                    return true;
                }
            }
            tip = Vector3.zero;
            _problem = "no Haptic Hand is tracked";
            return false;
        }

        private static string Told(ArrayOrigin origin)
        {
            return string.Format(
                CultureInfo.InvariantCulture, "{0:F1} mm, at most {1:F1} mm", 1e3f * origin.Residual, 1e3f * origin.Worst);
        }
    }
}
