using System.Collections.Generic;
using Pacinian.Wire;

namespace Pacinian
{
    /// <summary>What was asked of the server and not answered yet. Pure: times are given, in seconds.</summary>
    internal sealed class Asking
    {
        private const int Kept = 64; // renewals whose answer is waited for

        private readonly Dictionary<long, Asked> _asked = new Dictionary<long, Asked>();
        private readonly long[] _renewals = new long[Kept];
        private readonly double[] _sent = new double[Kept];
        private double _renewed = double.PositiveInfinity; // the first renewal since the last answer to one
        private long _id;

        /// <summary>A number for a message that is to be answered.</summary>
        public long Number()
        {
            _id = _id % uint.MaxValue + 1;
            return _id;
        }

        /// <summary>A renewal was sent.</summary>
        public void Renew(long id, double now)
        {
            _renewals[id % Kept] = id;
            _sent[id % Kept] = now;
            _renewed = now < _renewed ? now : _renewed;
        }

        /// <summary>A renewal was answered: when it was sent; NaN if that is not known any more.</summary>
        public double Renewed(long id)
        {
            _renewed = double.PositiveInfinity;
            return _renewals[id % Kept] == id ? _sent[id % Kept] : double.NaN;
        }

        /// <summary>A request was sent.</summary>
        public void Add(long id, Asked asked)
        {
            _asked.Add(id, asked);
        }

        /// <summary>What the answer of that number is to, which is not waited for any more; null if nothing.</summary>
        public Asked Take(long id)
        {
            Asked asked;
            if (_asked.TryGetValue(id, out asked))
            {
                _asked.Remove(id);
            }
            return asked;
        }

        /// <summary>What should have been answered by now, by name; "" if nothing.</summary>
        public string Late(double now, double timeout)
        {
            if (now - _renewed > timeout)
            {
                return "renew";
            }
            foreach (KeyValuePair<long, Asked> pair in _asked)
            {
                if (now > pair.Value.Until)
                {
                    return pair.Value.What;
                }
            }
            return "";
        }

        /// <summary>All that is still waited for will not be answered.</summary>
        public void Forget(News news)
        {
            foreach (KeyValuePair<long, Asked> pair in _asked)
            {
                news.Answer(pair.Value, null);
            }
            _asked.Clear();
        }
    }
}
