namespace Pacinian.Wire
{
    /// <summary>Reads arrays of numbers and texts, and numbers that may be nil.</summary>
    public sealed partial class Reader
    {
        /// <summary>The most keys of a map without a limit of its own.</summary>
        internal const int MostKeys = 4096;

        /// <summary>Reads a number in low..high, or nil.</summary>
        internal bool Real(ref double? value, double low, double high, bool above = false)
        {
            double read = 0.0;
            bool nil = Nil();
            if (!nil && !Real(ref read, low, high, above))
            {
                return false;
            }
            value = nil ? (double?)null : read;
            return true;
        }

        /// <summary>Reads texts with shortest..longest code points each.</summary>
        internal bool Texts(Items<string> items, int least, int most, int shortest, int longest)
        {
            int count;
            items.Clear();
            if (!Array(out count, least, most))
            {
                return false;
            }
            for (int i = 0; i < count; i++)
            {
                string item = items.Spare();
                if (!Text(ref item, shortest, longest))
                {
                    return Within(i);
                }
                items.Add(item);
            }
            return true;
        }

        /// <summary>Reads two numbers, each in low..high.</summary>
        internal bool Fixed(ref Vec2 value, double low = 0.0, double high = 0.0, bool above = false)
        {
            return Fixed(2) && Item(0, ref value.X, low, high, above) && Item(1, ref value.Y, low, high, above);
        }

        /// <summary>Reads three numbers, each in low..high; without limits if these are equal.</summary>
        internal bool Fixed(ref Vec3 value, double low = 0.0, double high = 0.0, bool above = false)
        {
            return Fixed(3) && Item(0, ref value.X, low, high, above) && Item(1, ref value.Y, low, high, above)
                && Item(2, ref value.Z, low, high, above);
        }

        /// <summary>Reads four numbers, each in low..high.</summary>
        internal bool Fixed(ref Quat value, double low = 0.0, double high = 0.0, bool above = false)
        {
            return Fixed(4) && Item(0, ref value.X, low, high, above) && Item(1, ref value.Y, low, high, above)
                && Item(2, ref value.Z, low, high, above) && Item(3, ref value.W, low, high, above);
        }

        /// <summary>Reads two integers, each in low..high.</summary>
        internal bool Fixed(ref Int2 value, long low = long.MinValue, long high = long.MaxValue)
        {
            return Fixed(2) && Item(0, ref value.X, low, high) && Item(1, ref value.Y, low, high);
        }

        /// <summary>Reads three integers, each in low..high.</summary>
        internal bool Fixed(ref Int3 value, long low = long.MinValue, long high = long.MaxValue)
        {
            return Fixed(3) && Item(0, ref value.X, low, high) && Item(1, ref value.Y, low, high)
                && Item(2, ref value.Z, low, high);
        }

        private bool Fixed(int wanted)
        {
            int count;
            return Array(out count, wanted, wanted);
        }

        private bool Item(int index, ref double value, double low, double high, bool above)
        {
            bool read = low == high ? Real(ref value) : Real(ref value, low, high, above);
            return read || Within(index);
        }

        private bool Item(int index, ref long value, long low, long high)
        {
            return Whole(ref value, low, high) || Within(index);
        }
    }
}
