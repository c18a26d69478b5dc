using System.Globalization;
using UnityEditor;
using UnityEngine;

namespace Pacinian.Haptics.Editing
{
    /// <summary>Inspector of a Haptic Server: its state, and the choice of plug-ins.</summary>
    [CustomEditor(typeof(HapticServer))]
    internal sealed class HapticServerEditor : Editor
    {
        /// <inheritdoc/>
        public override bool RequiresConstantRepaint()
        {
            return EditorApplication.isPlaying;
        }

        /// <inheritdoc/>
        public override void OnInspectorGUI()
        {
            HapticServer server = (HapticServer)target;
            Wire.Abilities told = HapticServer.Capabilities;
            serializedObject.Update();
            DrawPropertiesExcluding(serializedObject, "m_Script", "solver", "backend");
            Choose("Solver", "solver", told == null ? null : told.Solvers);
            Choose("Backend", "backend", told == null ? null : told.Backends);
            serializedObject.ApplyModifiedProperties();
            if (EditorApplication.isPlaying)
            {
                Tell(server);
            }
            if (server.Problem.Length > 0 && (server.IsConnected || !EditorApplication.isPlaying || server.Problem != server.Silence))
            {
                EditorGUILayout.HelpBox(server.Problem, MessageType.Warning);
            }
            Act(server);
        }

        private void Choose(string label, string field, Wire.Items<Wire.Plugin> plugins)
        {
            SerializedProperty property = serializedObject.FindProperty(field);
            if (plugins == null)
            {
                EditorGUILayout.PropertyField(property);
                return;
            }
            string[] names = PluginDropDown.Of(plugins, property.stringValue);
            int chosen = EditorGUILayout.Popup(label, PluginDropDown.Index(names, property.stringValue), names);
            property.stringValue = chosen == 0 ? "" : names[chosen];
        }

        private static void Tell(HapticServer server)
        {
            Wire.State state = server.Client == null ? null : server.Client.State;
            EditorGUILayout.LabelField("Status", server.Status + (server.Armed ? ", armed" : ""));
            EditorGUILayout.LabelField("Latency", Milliseconds(server.Latency));
            if (server.IsConnected)
            {
                EditorGUILayout.LabelField("Lease", Milliseconds(server.GrantedLease));
                EditorGUILayout.LabelField("Server", server.Client.Server);
            }
            if (state != null)
            {
                EditorGUILayout.LabelField("Output", state.Output + (state.Owner.Length > 0 ? ", of " + state.Owner : ""));
                EditorGUILayout.LabelField("In use", state.Solver + ", " + state.Backend + ", " + state.Technique);
                EditorGUILayout.LabelField("Samples", (state.Points.Numbers / 3).ToString(CultureInfo.InvariantCulture));
                EditorGUILayout.LabelField("Ticks", state.Rate.ToString("F0", CultureInfo.InvariantCulture) + " Hz, late " + state.Late);
            }
            if (server.Silence.Length > 0)
            {
                EditorGUILayout.HelpBox("Silent: " + server.Silence, MessageType.Info);
            }
        }

        private static void Act(HapticServer server)
        {
            EditorGUILayout.BeginHorizontal();
            GUI.enabled = EditorApplication.isPlaying;
            if (GUILayout.Button("Reconnect"))
            {
                server.Reconnect();
            }
            if (GUILayout.Button("Arm"))
            {
                server.Arm();
            }
            if (GUILayout.Button("Disarm"))
            {
                server.Disarm();
            }
            if (GUILayout.Button("Reset"))
            {
                server.ResetOutput();
            }
            GUI.enabled = true;
            EditorGUILayout.EndHorizontal();
            Color before = GUI.backgroundColor;
            GUI.backgroundColor = Color.red;
            if (GUILayout.Button("Emergency stop", GUILayout.Height(30f)))
            {
                server.EmergencyStop();
            }
            GUI.backgroundColor = before;
        }

        private static string Milliseconds(double seconds)
        {
            return (1e3 * seconds).ToString("F1", CultureInfo.InvariantCulture) + " ms";
        }
    }
}
