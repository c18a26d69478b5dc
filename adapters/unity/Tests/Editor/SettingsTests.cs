using NUnit.Framework;
using Pacinian.Haptics.Editing;
using UnityEditor;

namespace Pacinian.Haptics.Tests
{
    public sealed class SettingsTests
    {
        [Test]
        public void TheSliderOfAPressureShowsPascalsAndChangesThem()
        {
            Assert.AreEqual("Relative strength (8.0 of 20 Pa)", HapticEffectEditor.Label(8f, 20f));
            SerializedProperty pressure = new SerializedProperty { floatValue = 30f };
            HapticEffectEditor.Slide(pressure, 20f);
            Assert.AreEqual(30.0, pressure.floatValue, 0.0, "what is stronger stays, unless it is moved");
            EditorGUILayout.Slid = 0.25f;
            HapticEffectEditor.Slide(pressure, 20f);
            EditorGUILayout.Slid = null;
            Assert.AreEqual(5.0, pressure.floatValue, 1e-6);
        }

        [Test]
        public void TheProjectsSettingsBecomeAnAssetThatGamesFind()
        {
            Assert.AreEqual("Project/Pacinian", SettingsPage.Provide().settingsPath);
            SettingsPage.Draw("");
            PacinianSettings settings = PacinianSettings.Current;
            SettingsPage.Keep(settings);
            SettingsPage.Keep(settings);
            Assert.IsTrue(AssetDatabase.Assets["Assets/Resources/PacinianSettings.asset"] == settings);
        }
    }
}
