namespace Pacinian.Haptics
{
    /// <summary>Where a hand comes from.</summary>
    public enum HapticHandSource
    {
        /// <summary>A hand provider, as XR Hand.</summary>
        Tracker,

        /// <summary>The game calls SetJoints.</summary>
        Game,

        /// <summary>An open hand: its palm is here and faces down, its fingers point forward.</summary>
        Open,
    }
}
