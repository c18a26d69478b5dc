using UnityEditor;

namespace Pacinian.Haptics.Editing
{
    /// <summary>
    /// Ends the connection before the editor stops its thread: at a reload of scripts and at the end of play mode.
    /// Stops the started server when the editor quits. Forwards pauses of the editor to the connection.
    /// </summary>
    [InitializeOnLoad]
    internal static class ReloadGuard
    {
        static ReloadGuard()
        {
            StartedServer.FindElsewhere = ServerExecutable.Find;
            AssemblyReloadEvents.beforeAssemblyReload += HapticServer.ShutDown;
            EditorApplication.quitting += HapticServer.ShutDown;
            EditorApplication.quitting += EditorServer.Stop;
            EditorApplication.playModeStateChanged += Change;
            EditorApplication.pauseStateChanged += Pause;
            EditorApplication.update += KeepAlive;
        }

        private static void Pause(PauseState state)
        {
            if (HapticServer.Current != null)
            {
                HapticServer.Current.Pause(state == PauseState.Paused);
            }
        }

        private static void KeepAlive()
        {
            if (EditorApplication.isPaused && HapticServer.Current != null)
            {
                HapticServer.Current.KeepAlive();
            }
        }

        private static void Change(PlayModeStateChange change)
        {
            if (change == PlayModeStateChange.ExitingPlayMode)
            {
                HapticServer.ShutDown();
            }
        }
    }
}
