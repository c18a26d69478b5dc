using UnityEditor;

namespace Pacinian.Haptics.Editing
{
    /// <summary>
    /// Ends the connection before the editor stops our thread: at a reload of scripts, at the end of play mode. With the
    /// editor the server ends that it started.
    /// </summary>
    [InitializeOnLoad]
    internal static class ReloadGuard
    {
        static ReloadGuard()
        {
            AssemblyReloadEvents.beforeAssemblyReload += HapticServer.ShutDown;
            EditorApplication.quitting += HapticServer.ShutDown;
            EditorApplication.quitting += LocalServer.Stop;
            EditorApplication.playModeStateChanged += Change;
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
