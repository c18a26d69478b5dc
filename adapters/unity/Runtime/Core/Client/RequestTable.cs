using System.Collections.Generic;
using Pacinian.Wire;

namespace Pacinian
{
    /// <summary>What was asked of the server and not answered yet. Pure: times are given, in seconds.</summary>
    internal sealed class RequestTable
    {
        private const int MaxRenewals = 64; // whose answer is waited for

        private readonly Dictionary<long, PendingRequest> _pending = new Dictionary<long, PendingRequest>();
        private readonly long[] _renewals = new long[MaxRenewals];
        private readonly double[] _sent = new double[MaxRenewals];
        private double _renewed = double.PositiveInfinity; // the first renewal since the last answer to one
        private long _id;

        /// <summary>A number for a message that is to be answered.</summary>
        public long NextId()
        {
            _id = _id % uint.MaxValue + 1;
            return _id;
        }

        /// <summary>A renewal was sent.</summary>
        public void NoteRenewal(long id, double now)
        {
            _renewals[id % MaxRenewals] = id;
            _sent[id % MaxRenewals] = now;
            _renewed = now < _renewed ? now : _renewed;
        }

        /// <summary>A renewal was answered: when it was sent; NaN if that is not known any more.</summary>
        public double TakeRenewal(long id)
        {
            _renewed = double.PositiveInfinity;
            return _renewals[id % MaxRenewals] == id ? _sent[id % MaxRenewals] : double.NaN;
        }

        /// <summary>A request was sent.</summary>
        public void Add(long id, PendingRequest request)
        {
            _pending.Add(id, request);
        }

        /// <summary>What the answer of that number is to, which is not waited for any more; null if nothing.</summary>
        public PendingRequest Take(long id)
        {
            PendingRequest request;
            if (_pending.TryGetValue(id, out request))
            {
                _pending.Remove(id);
            }
            return request;
        }

        /// <summary>What should have been answered by now, by name; "" if nothing.</summary>
        public string FindLate(double now, double timeout)
        {
            if (now - _renewed > timeout)
            {
                return "renew";
            }
            foreach (KeyValuePair<long, PendingRequest> pair in _pending)
            {
                if (now > pair.Value.Until)
                {
                    return pair.Value.What;
                }
            }
            return "";
        }

        /// <summary>All that is still waited for will not be answered.</summary>
        public void Forget(Inbox inbox)
        {
            foreach (KeyValuePair<long, PendingRequest> pair in _pending)
            {
                inbox.Answer(pair.Value, null);
            }
            _pending.Clear();
        }
    }
}
