using UnityEditor;
using UnityEngine;

namespace Pacinian.Haptics.Editing
{
    /// <summary>Project Settings > Pacinian. The asset is created at the first change.</summary>
    internal static class SettingsPage
    {
        private const string Folder = "Assets/Resources";

        private static SerializedObject s_settings;

        [SettingsProvider]
        internal static SettingsProvider Provide()
        {
            return new SettingsProvider("Project/Pacinian", SettingsScope.Project)
            {
                label = "Pacinian", guiHandler = Draw, keywords = new[] { "haptics", "ultrasound", "server", "pressure" },
            };
        }

        internal static void Draw(string search)
        {
            if (s_settings == null || s_settings.targetObject == null)
            {
                s_settings = new SerializedObject(PacinianSettings.Current);
            }
            s_settings.Update();
            foreach (string field in new[] { "serverCommand", "serverArguments", "fullPressure" })
            {
                EditorGUILayout.PropertyField(s_settings.FindProperty(field));
            }
            if (s_settings.ApplyModifiedProperties())
            {
                Keep((PacinianSettings)s_settings.targetObject);
            }
            EditorGUILayout.HelpBox("Start Server of the Haptic Server starts " + StartedServer.Program, MessageType.Info);
        }

        /// <summary>Creates the asset if there is none, in a folder Resources, where games find it by its name.</summary>
        internal static void Keep(PacinianSettings settings)
        {
            if (AssetDatabase.Contains(settings))
            {
                return;
            }
            if (!AssetDatabase.IsValidFolder(Folder))
            {
                AssetDatabase.CreateFolder("Assets", "Resources");
            }
            AssetDatabase.CreateAsset(settings, Folder + "/" + PacinianSettings.Asset + ".asset");
        }
    }
}
