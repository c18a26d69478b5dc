using System.Globalization;
using System.Text;

namespace Pacinian.Wire
{
    /// <summary>Reads the tokens of JSON one by one. If a token is not there, returns false, or '\0'.</summary>
    internal sealed class JsonScanner
    {
        private readonly StringBuilder _buffer = new StringBuilder();
        private readonly string _source;
        private int _at;

        public JsonScanner(string source)
        {
            _source = source;
        }

        /// <summary>Whether nothing but white space follows.</summary>
        public bool End
        {
            get { return Next == '\0' && _at == _source.Length; }
        }

        /// <summary>The next character after white space.</summary>
        public char Next
        {
            get
            {
                while (_at < _source.Length && " \t\r\n".IndexOf(_source[_at]) >= 0)
                {
                    _at++;
                }
                return Here;
            }
        }

        private char Here
        {
            get { return _at < _source.Length ? _source[_at] : '\0'; }
        }

        /// <summary>Consumes a character after white space.</summary>
        public bool Take(char c)
        {
            return Next == c && TakeHere(c);
        }

        /// <summary>Consumes a word.</summary>
        public bool Word(string word)
        {
            bool same = string.CompareOrdinal(_source, _at, word, 0, word.Length) == 0;
            _at += same ? word.Length : 0;
            return same;
        }

        /// <summary>Consumes a number. It is null if it is not an integer, or has more than 64 bits.</summary>
        public bool Number(out long? whole)
        {
            int start = _at;
            TakeHere('-');
            bool valid = TakeHere('0') || Digits();
            int end = _at;
            valid = valid && (!TakeHere('.') || Digits());
            valid = valid && (!(TakeHere('e') || TakeHere('E')) || Exponent());
            long value;
            string digits = _source.Substring(start, end - start);
            bool fits = long.TryParse(digits, NumberStyles.AllowLeadingSign, CultureInfo.InvariantCulture, out value);
            whole = valid && fits && end == _at ? value : (long?)null;
            return valid;
        }

        /// <summary>Consumes a text in quotes.</summary>
        public bool Text(out string text)
        {
            text = null;
            if (!Take('"'))
            {
                return false;
            }
            _buffer.Length = 0;
            while (_at < _source.Length)
            {
                char c = _source[_at++];
                if (c == '"')
                {
                    text = _buffer.ToString();
                    return Paired(text);
                }
                if (c < ' ' || (c == '\\' && !Escape(out c)))
                {
                    return false;
                }
                _buffer.Append(c);
            }
            return false;
        }

        private bool Escape(out char c)
        {
            const string Letters = "\"\\/bfnrt", Meant = "\"\\/\b\f\n\r\t";
            c = Here;
            _at++;
            int letter = Letters.IndexOf(c);
            if (letter >= 0)
            {
                c = Meant[letter];
                return true;
            }
            ushort code = 0;
            bool valid = c == 'u' && _at + 4 <= _source.Length && ushort.TryParse(
                _source.Substring(_at, 4), NumberStyles.AllowHexSpecifier, CultureInfo.InvariantCulture, out code);
            c = (char)code;
            _at += valid ? 4 : 0;
            return valid;
        }

        /// <summary>Returns whether all surrogates come in pairs.</summary>
        private static bool Paired(string text)
        {
            for (int i = 0; i < text.Length; i++)
            {
                if (char.IsSurrogate(text[i]) && (i + 1 == text.Length || !char.IsSurrogatePair(text[i], text[++i])))
                {
                    return false;
                }
            }
            return true;
        }

        private bool Exponent()
        {
            _at += Here == '+' || Here == '-' ? 1 : 0;
            return Digits();
        }

        private bool Digits()
        {
            int start = _at;
            while (Here >= '0' && Here <= '9')
            {
                _at++;
            }
            return _at > start;
        }

        private bool TakeHere(char c)
        {
            bool same = _at < _source.Length && Here == c;
            _at += same ? 1 : 0;
            return same;
        }
    }
}
