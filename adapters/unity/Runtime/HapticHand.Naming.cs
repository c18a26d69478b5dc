using Pacinian.Wire;

namespace Pacinian.Haptics
{
    /// <summary>The hand's name on the server, which refuses two hands of one name.</summary>
    public sealed partial class HapticHand
    {
        /// <summary>
        /// Returns a name that no other hand has: the side for the first hand of its side, "right 2" for the next. A hand
        /// keeps it until its side changes.
        /// </summary>
        private string MakeName()
        {
            string own = side == HandFrameSide.Left ? "left" : "right", name = own;
            if (_frame.Name.StartsWith(own, System.StringComparison.Ordinal))
            {
                return _frame.Name;
            }
            for (int i = 2; IsTaken(name); i++)
            {
                name = own + " " + i;
            }
            return name;
        }

        private static bool IsTaken(string name)
        {
            for (int i = 0; i < All.Count; i++)
            {
                if (All[i]._frame.Name == name)
                {
                    return true;
                }
            }
            return false;
        }
    }
}
