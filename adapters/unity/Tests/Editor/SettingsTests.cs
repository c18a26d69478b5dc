using NUnit.Framework;
using Pacinian.Haptics.Editing;
using UnityEditor;

namespace Pacinian.Haptics.Tests
{
    public sealed class SettingsTests
    {
        [Test]
        public void TheSliderOfAPressureIsLabelledInPascals()
        {
            Assert.AreEqual("Relative strength (8.0 of 20 Pa)", HapticEffectEditor.Label(8f, 20f));
        }

        [Test]
        public void ThePageIsAmongTheProjectsSettings()
        {
            Assert.AreEqual("Project/Pacinian", SettingsPage.Provide().settingsPath);
        }

        [Test]
        public void ADropDownHasTheServersNamesAndTheOneThatIsChosen()
        {
            Wire.Abilities told = new Wire.Abilities();
            told.Solvers.Add(new Wire.Plugin { Name = "gs" });
            string[] names = PluginDropDown.Of(told.Solvers, "mine");
            Assert.AreEqual("(the server's),gs,mine", string.Join(",", names));
            Assert.AreEqual(0, PluginDropDown.Index(names, ""));
            Assert.AreEqual(1, PluginDropDown.Index(names, "gs"));
        }

#if PACINIAN_STUBS // Unity draws only while it calls OnGUI, and would keep the asset in the project
        [Test]
        public void TheSliderOfAPressureChangesThePascals()
        {
            SerializedProperty pressure = new SerializedObject(PacinianSettings.Current).FindProperty("fullPressure");
            pressure.floatValue = 30f;
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
            SettingsPage.Draw("");
            PacinianSettings settings = PacinianSettings.Current;
            SettingsPage.Keep(settings);
            SettingsPage.Keep(settings);
            Assert.IsTrue(AssetDatabase.Assets["Assets/Resources/PacinianSettings.asset"] == settings);
        }
#endif
    }
}
