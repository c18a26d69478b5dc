using UnityEngine;

namespace Pacinian.Haptics
{
    /// <summary>Shows on the screen whether the array sounds, and if not, why and what to do. Needs no canvas.</summary>
    [AddComponentMenu("Pacinian/Haptic Status")]
    public sealed class HapticStatus : MonoBehaviour
    {
        private const float Margin = 12f; // [pixels]

        [SerializeField, Range(8, 64), Tooltip("Size of the letters [pixels].")] private int fontSize = 16;
        [SerializeField, Tooltip("Show the text also while the array sounds.")] private bool showWhileSounding = true;

        private GUIStyle _style;

        /// <summary>The size of the letters [pixels].</summary>
        public int FontSize
        {
            get { return fontSize; }
            set { fontSize = value; _style = null; }
        }

        /// <summary>Whether to show the text also while the array sounds.</summary>
        public bool ShowWhileSounding
        {
            get { return showWhileSounding; }
            set { showWhileSounding = value; }
        }

        /// <summary>The text that is shown; "" for none.</summary>
        public string Text
        {
            get
            {
                HapticServer server = HapticServer.Current;
                if (server == null)
                {
                    return "Silent: there is no Haptic Server that is enabled";
                }
                string why = server.Silence;
                return why.Length > 0 ? "Silent: " + why
                    : showWhileSounding && server.Output == HapticOutput.Sounding ? "Sounding" : "";
            }
        }

        private void OnGUI()
        {
            string text = Text;
            if (text.Length > 0)
            {
                _style = _style ?? new GUIStyle(GUI.skin.label) { fontSize = fontSize, wordWrap = true };
                GUI.Label(new Rect(Margin, Margin, Screen.width - 2f * Margin, 6f * fontSize), text, _style);
            }
        }
    }
}
