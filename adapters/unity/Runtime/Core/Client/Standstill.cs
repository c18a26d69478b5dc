namespace Pacinian
{
    /// <summary>A standstill that is over: the game did not tick for longer than its lease while it was armed.</summary>
    public struct Standstill
    {
        /// <summary>The time between the two ticks [s].</summary>
        public double Seconds;

        /// <summary>
        /// Whether the whole program stood still, including the client's thread, as at a breakpoint or while the
        /// computer slept. If false, only the game's thread stood still, as in a long frame or a pause of the editor.
        /// </summary>
        public bool Whole;

        /// <summary>Returns a description in one line.</summary>
        public override string ToString()
        {
            string seconds = Seconds.ToString("F1", System.Globalization.CultureInfo.InvariantCulture);
            string what = Whole ? "the program stood still (a breakpoint, or the computer slept)" : "the game did not tick";
            return what + " for " + seconds + " s, so it was silent meanwhile";
        }
    }
}
