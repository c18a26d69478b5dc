using UnityEditor;
using UnityEngine;
using UnityEngine.SceneManagement;

namespace Pacinian.Haptics.Editing
{
    /// <summary>Window > Pacinian > Server: starts and stops a server on this computer, and shows its log.</summary>
    internal sealed class ServerWindow : EditorWindow
    {
        private const double Period = 0.5; // [s] between two reads of the log

        private string _arguments = "--backend simulated", _problem = "", _log = "";
        private Vector2 _at;
        private double _next;

        [MenuItem("Window/Pacinian/Server")]
        private static void Open()
        {
            GetWindow<ServerWindow>("Pacinian Server");
        }

        [MenuItem("Window/Pacinian/Emergency stop")]
        private static void StopNow()
        {
            HapticServer server = HapticServer.Current;
            foreach (GameObject root in SceneManager.GetActiveScene().GetRootGameObjects())
            {
                foreach (HapticServer found in root.GetComponentsInChildren<HapticServer>())
                {
                    server = server == null ? found : server; // in edit mode none is the current one
                }
            }
            if (server != null)
            {
                server.EmergencyStop();
                return;
            }
            new HapticClient(new Options()).Stop(HapticServer.LogUnstopped);
        }

        private void OnEnable()
        {
            EditorApplication.update += Look;
        }

        private void OnDisable()
        {
            EditorApplication.update -= Look;
        }

        private void Look()
        {
            if (EditorApplication.timeSinceStartup >= _next)
            {
                _next = EditorApplication.timeSinceStartup + Period;
                _log = EditorServer.Log();
                Repaint();
            }
        }

        private void OnGUI()
        {
            string executable = ServerExecutable.Find();
            EditorGUILayout.LabelField("Program", executable.Length > 0 ? executable : "not found");
            if (executable.Length == 0)
            {
                EditorGUILayout.HelpBox(ServerExecutable.Advice, MessageType.Warning);
            }
            if (GUILayout.Button("Choose the program..."))
            {
                string chosen = EditorUtility.OpenFilePanel("pacinian", "", "");
                ServerExecutable.Chosen = chosen.Length > 0 ? chosen : ServerExecutable.Chosen;
            }
            Library(executable);
            _arguments = EditorGUILayout.TextField("pacinian serve", _arguments);
            EditorGUILayout.BeginHorizontal();
            GUI.enabled = executable.Length > 0 && !EditorServer.Running;
            if (GUILayout.Button("Start"))
            {
                _problem = EditorServer.Start(executable, _arguments);
            }
            GUI.enabled = EditorServer.Running;
            if (GUILayout.Button("Stop"))
            {
                EditorServer.Stop();
            }
            GUI.enabled = true;
            EditorGUILayout.EndHorizontal();
            if (_problem.Length > 0)
            {
                EditorGUILayout.HelpBox(_problem, MessageType.Error);
            }
            EditorGUILayout.LabelField("State", EditorServer.Running ? "running" : "not started here");
            _at = EditorGUILayout.BeginScrollView(_at);
            float height = EditorStyles.wordWrappedLabel.CalcHeight(new GUIContent(_log), 600f);
            EditorGUILayout.SelectableLabel(_log, EditorStyles.wordWrappedLabel, GUILayout.MinHeight(height));
            EditorGUILayout.EndScrollView();
        }

        private void Library(string executable)
        {
            if (NativeLibrary.There)
            {
                return;
            }
            EditorGUILayout.HelpBox(NativeLibrary.Advice, MessageType.Info);
            string found = NativeLibrary.Find(executable);
            string path = "";
            if (found.Length > 0 && GUILayout.Button("Copy " + found))
            {
                path = found;
            }
            if (GUILayout.Button("Choose libzmq..."))
            {
                path = EditorUtility.OpenFilePanel("libzmq", "", "");
            }
            if (path.Length > 0)
            {
                _problem = NativeLibrary.Install(path);
                AssetDatabase.Refresh();
            }
        }
    }
}
