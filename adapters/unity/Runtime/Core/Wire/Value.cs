namespace Pacinian.Wire
{
    /// <summary>The type of a <see cref="Value"/>.</summary>
    public enum ValueKind
    {
        /// <summary>Nil.</summary>
        Nil,

        /// <summary>A boolean.</summary>
        Bool,

        /// <summary>An integer.</summary>
        Whole,

        /// <summary>A floating-point number.</summary>
        Real,

        /// <summary>A text.</summary>
        Text,

        /// <summary>Any other type, stored as its encoded bytes.</summary>
        Other,
    }

    /// <summary>A value of any type, such as a setting of a plug-in.</summary>
    public struct Value
    {
        private long _whole;
        private double _real;
        private Bulk _bytes;

        /// <summary>The type.</summary>
        public ValueKind Kind { get; private set; }

        /// <summary>The text; null if it is not a text.</summary>
        public string Text { get; private set; }

        /// <summary>The number; 1 for true; otherwise 0.</summary>
        public double Number
        {
            get { return Kind == ValueKind.Real ? _real : _whole; }
        }

        /// <summary>Whether the value is true.</summary>
        public bool True
        {
            get { return Kind == ValueKind.Bool && _whole != 0; }
        }

        /// <summary>The integer; 1 for true; otherwise 0.</summary>
        public long Whole
        {
            get { return _whole; }
        }

        /// <summary>Returns a boolean value.</summary>
        public static Value Of(bool value)
        {
            return new Value { Kind = ValueKind.Bool, _whole = value ? 1 : 0 };
        }

        /// <summary>Returns an integer value.</summary>
        public static Value Of(long value)
        {
            return new Value { Kind = ValueKind.Whole, _whole = value };
        }

        /// <summary>Returns a floating-point value.</summary>
        public static Value Of(double value)
        {
            return new Value { Kind = ValueKind.Real, _real = value };
        }

        /// <summary>Returns a text value.</summary>
        public static Value Of(string value)
        {
            return new Value { Kind = ValueKind.Text, Text = value };
        }

        /// <summary>Returns a value from bytes that are MessagePack.</summary>
        internal static Value Of(byte[] data, int start, int count)
        {
            Value made = new Value { Kind = ValueKind.Other };
            made._bytes.Set(data, start, count);
            return made;
        }

        /// <summary>Writes the value.</summary>
        public void Write(Writer w)
        {
            switch (Kind)
            {
                case ValueKind.Bool: w.Bool(_whole != 0); break;
                case ValueKind.Whole: w.Whole(_whole); break;
                case ValueKind.Real: w.Real(_real); break;
                case ValueKind.Text: w.Text(Text); break;
                case ValueKind.Other: w.Raw(_bytes.Data, 0, _bytes.Count); break;
                default: w.Nil(); break;
            }
        }
    }
}
