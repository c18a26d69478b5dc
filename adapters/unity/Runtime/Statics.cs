using UnityEngine;

namespace Pacinian.Haptics
{
    /// <summary>What is static outlives play mode where the domain is not loaded anew: here it is emptied.</summary>
    internal static class Statics
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
