namespace Pacinian
{
    /// <summary>The game did not tick for longer than its lease while it was armed, and goes on now.</summary>
    public struct Standstill
    {
        /// <summary>From one tick to the next [s].</summary>
        public double Seconds;

        /// <summary>
        /// Whether the whole program stood still, this client's own thread, too: a breakpoint, or a computer that slept. If
        /// not, only the game's thread did: a long frame, or a pause of the editor.
        /// </summary>
        public bool Whole;

        /// <summary>In one line, for people.</summary>
        public override string ToString()
        {
            string seconds = Seconds.ToString("F1", System.Globalization.CultureInfo.InvariantCulture);
            string what = Whole ? "the program stood still (a breakpoint, or the computer slept)" : "the game did not tick";
            return what + " for " + seconds + " s, so it was silent; it goes on";
        }
    }
}
