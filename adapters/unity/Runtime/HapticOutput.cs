namespace Pacinian.Haptics
{
    /// <summary>The state of the output, as the server reports it.</summary>
    public enum HapticOutput
    {
        /// <summary>No server has reported it.</summary>
        Unknown,

        /// <summary>Silent: no client has armed the output, or there is nothing to feel.</summary>
        Silent,

        /// <summary>Sounding: something can be felt.</summary>
        Sounding,

        /// <summary>Silent until the renderer, which is late, continues.</summary>
        Stale,

        /// <summary>Silent after an emergency stop, until ResetOutput.</summary>
        Stopped,

        /// <summary>Silent after a failure of a plug-in or device, until ResetOutput.</summary>
        Faulted,
    }
}
