using UnityEngine;

namespace Pacinian.Haptics
{
    /// <summary>
    /// What all scenes of a project share: Project Settings > Pacinian. An asset in a folder Resources, so that games have it.
    /// </summary>
    public sealed class PacinianSettings : ScriptableObject
    {
        /// <summary>The asset's name in a folder Resources.</summary>
        internal const string Asset = "PacinianSettings";

        private static PacinianSettings s_current;

        [SerializeField, Tooltip("The program that Start Server starts: its path, or its name if the system finds it.")]
        private string serverCommand = "pacinian";
        [SerializeField, Tooltip("For `pacinian serve`, a word each without spaces: --backend and simulated, or a configuration's path.")]
        private string[] serverArguments = new string[0];
        [SerializeField, Min(0.001f), Tooltip("The radiation pressure of an effect whose relative strength is 1 [Pa].")]
        private float fullPressure = 20f;

        /// <summary>The project's, or those by default where it has none.</summary>
        public static PacinianSettings Current
        {
            get
            {
                if (s_current == null)
                {
                    PacinianSettings kept = Resources.Load<PacinianSettings>(Asset);
                    s_current = kept != null ? kept : CreateInstance<PacinianSettings>();
                }
                return s_current;
            }
        }

        /// <summary>The program that Start Server starts if StreamingAssets/pacinian has none: its path, or its name.</summary>
        public string ServerCommand
        {
            get { return serverCommand; }
            set { serverCommand = value ?? ""; }
        }

        /// <summary>For `pacinian serve`, a word each, without spaces.</summary>
        public string[] ServerArguments
        {
            get { return serverArguments; }
            set { serverArguments = value ?? new string[0]; }
        }

        /// <summary>The radiation pressure of an effect whose relative strength is 1 [Pa].</summary>
        public float FullPressure
        {
            get { return fullPressure; }
            set { fullPressure = Mathf.Max(value, 0.001f); }
        }

        /// <summary>The asset is another now.</summary>
        internal static void Forget()
        {
            s_current = null;
        }
    }
}
