using System.Collections.Generic;

namespace Pacinian.Wire
{
    /// <summary>The texts and integers of a JSON object, by key. Other values must be valid JSON, and are left out.</summary>
    public sealed class FlatJson
    {
        private const int Deepest = 32;

        private readonly Dictionary<string, string> _texts = new Dictionary<string, string>();
        private readonly Dictionary<string, long> _numbers = new Dictionary<string, long>();
        private readonly JsonScanner _scanner;

        private FlatJson(string source)
        {
            _scanner = new JsonScanner(source);
        }

        /// <summary>Parses an object. Returns null if the text is anything else. If a key is repeated, the last value counts.</summary>
        public static FlatJson Parse(string source)
        {
            FlatJson json = new FlatJson(source);
            return json.Object(0) && json._scanner.End ? json : null;
        }

        /// <summary>Returns the text of a key, or `otherwise`.</summary>
        public string Text(string key, string otherwise)
        {
            string value;
            return _texts.TryGetValue(key, out value) ? value : otherwise;
        }

        /// <summary>Returns the integer of a key, or `otherwise`.</summary>
        public long Number(string key, long otherwise)
        {
            long value;
            return _numbers.TryGetValue(key, out value) ? value : otherwise;
        }

        private bool Object(int depth)
        {
            if (!_scanner.Take('{'))
            {
                return false;
            }
            if (_scanner.Take('}'))
            {
                return true;
            }
            do
            {
                string key;
                if (!_scanner.Text(out key) || !_scanner.Take(':') || !Value(depth, depth == 0 ? key : null))
                {
                    return false;
                }
            }
            while (_scanner.Take(','));
            return _scanner.Take('}');
        }

        private bool Array(int depth)
        {
            if (!_scanner.Take('['))
            {
                return false;
            }
            if (_scanner.Take(']'))
            {
                return true;
            }
            do
            {
                if (!Value(depth, null))
                {
                    return false;
                }
            }
            while (_scanner.Take(','));
            return _scanner.Take(']');
        }

        /// <summary>Reads a value, and stores it if it has a key.</summary>
        private bool Value(int depth, string key)
        {
            if (key != null)
            {
                _texts.Remove(key);
                _numbers.Remove(key);
            }
            string text;
            long? number;
            switch (_scanner.Next)
            {
                case '{': return depth < Deepest && Object(depth + 1);
                case '[': return depth < Deepest && Array(depth + 1);
                case 't': return _scanner.Word("true");
                case 'f': return _scanner.Word("false");
                case 'n': return _scanner.Word("null");
                case '"':
                    bool read = _scanner.Text(out text);
                    if (read && key != null)
                    {
                        _texts[key] = text;
                    }
                    return read;
                default:
                    read = _scanner.Number(out number);
                    if (number.HasValue && key != null)
                    {
                        _numbers[key] = number.Value;
                    }
                    return read;
            }
        }
    }
}
