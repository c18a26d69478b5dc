using UnityEngine;

namespace Pacinian.Haptics
{
    /// <summary>
    /// The settings of a project, for all scenes: Project Settings > Pacinian. The asset lies in a folder Resources, so
    /// that builds contain it.
    /// </summary>
    public sealed class PacinianSettings : ScriptableObject
    {
        /// <summary>The asset's name in a folder Resources.</summary>
        internal const string Asset = "PacinianSettings";

        private static PacinianSettings s_current;

        [SerializeField, Tooltip("The program that Start Server starts: its path, or its name if the system finds it.")]
        private string serverCommand = "pacinian";
        [SerializeField, Tooltip("Arguments of `pacinian serve`, one word each: --backend and simulated, or the path of a configuration.")]
        private string[] serverArguments = new string[0];
        [SerializeField, Min(0.001f), Tooltip("The radiation pressure of an effect whose relative strength is 1 [Pa].")]
        private float fullPressure = 20f;

        /// <summary>The project's settings, or the defaults if it has none.</summary>
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

        /// <summary>The arguments of `pacinian serve`, one word each, without spaces.</summary>
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

        /// <summary>Forgets the loaded asset, because it may have changed.</summary>
        internal static void Forget()
        {
            s_current = null;
        }
    }
}
