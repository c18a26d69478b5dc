namespace Pacinian.Haptics
{
    /// <summary>What the array does, as the server says.</summary>
    public enum HapticOutput
    {
        /// <summary>No server has told.</summary>
        Unknown,

        /// <summary>No client has armed the output, or there is nothing to feel.</summary>
        Silent,

        /// <summary>Something can be felt.</summary>
        Sounding,

        /// <summary>The renderer is late: silent until it goes on.</summary>
        Stale,

        /// <summary>After an emergency stop, until ResetOutput.</summary>
        Stopped,

        /// <summary>A plug-in or device failed, until ResetOutput.</summary>
        Faulted,
    }
}
