using UnityEngine;

namespace Pacinian.Haptics
{
    /// <summary>Resets static state when play mode starts, because it survives if the domain is not reloaded.</summary>
    internal static class StaticStateReset
    {
        [RuntimeInitializeOnLoadMethod(RuntimeInitializeLoadType.SubsystemRegistration)]
        internal static void Reset()
        {
            HapticServer.ShutDown();
            PacinianSettings.Forget();
            HapticEffect.All.Clear();
            HapticHand.All.Clear();
            QuietZone.All.Clear();
            ArrayOrigin.Forget();
        }
    }
}
