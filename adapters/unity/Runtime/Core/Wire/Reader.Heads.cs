using System;

namespace Pacinian.Wire
{
    /// <summary>Reads the heads of values: their kind and size.</summary>
    public sealed partial class Reader
    {
        [Flags]
        private enum Kind
        {
            None = 0,
            Nil = 1,
            Bool = 2,
            Whole = 4,
            Huge = 8, // an integer beyond 63 bits
            Real = 16,
            Text = 32,
            Binary = 64,
            Array = 128,
            Map = 256,
            Extension = 512,
            Never = 1024, // a byte that MessagePack does not use
        }

        /// <summary>A value, or the head of an array or map with Count items or keys.</summary>
        private struct Head
        {
            public Kind Kind;
            public long Whole;
            public double Number;
            public int Start, Count;
            public bool Cut; // not all bytes are there
        }

        /// <summary>Reads a whole value, or the head of an array or map.</summary>
        private bool Take(out Head head)
        {
            head = new Head();
            if (_at >= _end)
            {
                return Broken("is cut short");
            }
            int code = _data[_at++];
            if (code < 0x80 || code >= 0xE0)
            {
                return Whole(ref head, (sbyte)code);
            }
            if (code < 0xA0)
            {
                return Sized(ref head, code < 0x90 ? Kind.Map : Kind.Array, code & 15);
            }
            if (code < 0xC0)
            {
                return Sized(ref head, Kind.Text, code & 31);
            }
            ulong number;
            switch (code)
            {
                case 0xC0:
                    head.Kind = Kind.Nil;
                    return true;
                case 0xC2:
                case 0xC3:
                    head.Kind = Kind.Bool;
                    head.Whole = code & 1;
                    return true;
                case 0xCA:
                    return Big(4, out number) && Real(ref head, new Bits { Whole = (uint)number }.Single);
                case 0xCB:
                    return Big(8, out number) && Real(ref head, BitConverter.Int64BitsToDouble((long)number));
                case 0xCC:
                case 0xCD:
                case 0xCE:
                case 0xCF:
                    return Big(1 << (code - 0xCC), out number) && Positive(ref head, number);
                case 0xD0:
                    return Big(1, out number) && Whole(ref head, (sbyte)number);
                case 0xD1:
                    return Big(2, out number) && Whole(ref head, (short)number);
                case 0xD2:
                    return Big(4, out number) && Whole(ref head, (int)number);
                case 0xD3:
                    return Big(8, out number) && Whole(ref head, (long)number);
                case 0xC4:
                case 0xC5:
                case 0xC6:
                    return Big(1 << (code - 0xC4), out number) && Sized(ref head, Kind.Binary, (long)number);
                case 0xC7:
                case 0xC8:
                case 0xC9:
                    return Big(1 << (code - 0xC7), out number) && Sized(ref head, Kind.Extension, (long)number + 1);
                case 0xD4:
                case 0xD5:
                case 0xD6:
                case 0xD7:
                case 0xD8:
                    return Sized(ref head, Kind.Extension, (1 << (code - 0xD4)) + 1);
                case 0xD9:
                case 0xDA:
                case 0xDB:
                    return Big(1 << (code - 0xD9), out number) && Sized(ref head, Kind.Text, (long)number);
                case 0xDC:
                case 0xDD:
                    return Big(2 << (code - 0xDC), out number) && Sized(ref head, Kind.Array, (long)number);
                case 0xDE:
                case 0xDF:
                    return Big(2 << (code - 0xDE), out number) && Sized(ref head, Kind.Map, (long)number);
                default:
                    head.Kind = Kind.Never;
                    return true;
            }
        }

        private static bool Whole(ref Head head, long value)
        {
            head.Kind = Kind.Whole;
            head.Whole = value;
            head.Number = value;
            return true;
        }

        private static bool Positive(ref Head head, ulong value)
        {
            head.Kind = value <= long.MaxValue ? Kind.Whole : Kind.Huge;
            head.Whole = (long)value;
            head.Number = value;
            return true;
        }

        private static bool Real(ref Head head, double value)
        {
            head.Kind = Kind.Real;
            head.Number = value;
            return true;
        }

        /// <summary>
        /// Reads a head with a size. Text and bytes are consumed as far as they are there; items of arrays and maps are
        /// only counted.
        /// </summary>
        private bool Sized(ref Head head, Kind kind, long count)
        {
            head.Kind = kind;
            head.Start = _at;
            head.Count = (int)Math.Min(count, int.MaxValue);
            if (kind == Kind.Array || kind == Kind.Map)
            {
                return true;
            }
            head.Cut = count > _end - _at;
            _at = head.Cut ? _end : _at + head.Count;
            return !head.Cut || kind != Kind.Text || Broken("is cut short");
        }

        private bool Big(int size, out ulong value)
        {
            value = 0;
            if (size > _end - _at)
            {
                return Broken("is cut short");
            }
            for (int i = 0; i < size; i++)
            {
                value = (value << 8) | _data[_at++];
            }
            return true;
        }
    }
}
