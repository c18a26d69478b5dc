namespace Pacinian.Haptics
{
    /// <summary>The source of a hand's joints.</summary>
    public enum HapticHandSource
    {
        /// <summary>A hand provider, such as XR Hand.</summary>
        Tracker,

        /// <summary>The game calls SetJoints.</summary>
        Game,

        /// <summary>An open hand: its palm is at this object and faces down, its fingers point forward.</summary>
        Open,

        /// <summary>For tests: an open hand that the mouse moves. It is there while the left button is down.</summary>
        Mouse,
    }
}
