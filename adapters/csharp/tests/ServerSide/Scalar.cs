namespace Pacinian.Wire
{
    /// <summary>Reads settings, which a client only writes.</summary>
    public sealed partial class Reader
    {
        /// <summary>Reads a boolean, an integer, a number in low..high, or a text of least..most code points.</summary>
        internal bool Scalar(ref Value value, double low, double high, int least, int most)
        {
            int start = _at;
            Head head;
            if (!Take(out head))
            {
                return false;
            }
            const Kind Scalars = Kind.Bool | Kind.Whole | Kind.Huge | Kind.Real | Kind.Text;
            if ((head.Kind & Scalars) == 0)
            {
                return Wrong("must be bool, int, float or str", head);
            }
            _at = start;
            double number = 0.0;
            string text = value.Text;
            bool valid = head.Kind == Kind.Real ? Real(ref number, low, high)
                : head.Kind != Kind.Text || Text(ref text, least, most);
            _at = start;
            return valid && Any(ref value);
        }
    }
}
