namespace Pacinian.Wire
{
    /// <summary>What a <see cref="Value"/> is.</summary>
    public enum ValueKind
    {
        /// <summary>Nil.</summary>
        Nil,

        /// <summary>True or false.</summary>
        Bool,

        /// <summary>A whole number.</summary>
        Whole,

        /// <summary>A number.</summary>
        Real,

        /// <summary>Text.</summary>
        Text,

        /// <summary>Anything else, as the bytes that it came in.</summary>
        Other,
    }

    /// <summary>A value of some type: a setting of a plug-in.</summary>
    public struct Value
    {
        private long _whole;
        private double _real;
        private Bulk _bytes;

        /// <summary>What it is.</summary>
        public ValueKind Kind { get; private set; }

        /// <summary>The text; null if it is none.</summary>
        public string Text { get; private set; }

        /// <summary>The number, if it is one; of true 1; else 0.</summary>
        public double Number
        {
            get { return Kind == ValueKind.Real ? _real : _whole; }
        }

        /// <summary>Whether it is true.</summary>
        public bool True
        {
            get { return Kind == ValueKind.Bool && _whole != 0; }
        }

        /// <summary>The whole number, if it is one; of true 1; else 0.</summary>
        public long Whole
        {
            get { return _whole; }
        }

        /// <summary>True or false.</summary>
        public static Value Of(bool value)
        {
            return new Value { Kind = ValueKind.Bool, _whole = value ? 1 : 0 };
        }

        /// <summary>A whole number.</summary>
        public static Value Of(long value)
        {
            return new Value { Kind = ValueKind.Whole, _whole = value };
        }

        /// <summary>A number.</summary>
        public static Value Of(double value)
        {
            return new Value { Kind = ValueKind.Real, _real = value };
        }

        /// <summary>A text.</summary>
        public static Value Of(string value)
        {
            return new Value { Kind = ValueKind.Text, Text = value };
        }

        /// <summary>Bytes that are MessagePack already.</summary>
        internal static Value Of(byte[] data, int start, int count)
        {
            Value made = new Value { Kind = ValueKind.Other };
            made._bytes.Set(data, start, count);
            return made;
        }

        /// <summary>Writes it.</summary>
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
