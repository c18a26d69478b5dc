using System.Collections.Generic;
using Pacinian.Wire;

namespace Pacinian
{
    /// <summary>The requests that the server has not answered yet. Does not read a clock: times are arguments [s].</summary>
    internal sealed class UnansweredRequests
    {
        private const int MaxRenewals = 64; // that can wait for an answer

        private readonly Dictionary<long, PendingRequest> _pending = new Dictionary<long, PendingRequest>();
        private readonly long[] _renewals = new long[MaxRenewals];
        private readonly double[] _sent = new double[MaxRenewals];
        private double _renewed = double.PositiveInfinity; // the first renewal since the last answer to one
        private long _id;

        /// <summary>Returns a new ID for a message.</summary>
        public long NextId()
        {
            _id = _id % uint.MaxValue + 1;
            return _id;
        }

        /// <summary>Records that a renewal was sent.</summary>
        public void NoteRenewal(long id, double now)
        {
            _renewals[id % MaxRenewals] = id;
            _sent[id % MaxRenewals] = now;
            _renewed = now < _renewed ? now : _renewed;
        }

        /// <summary>Returns when an answered renewal was sent; NaN if that is no longer known.</summary>
        public double TakeRenewal(long id)
        {
            _renewed = double.PositiveInfinity;
            return _renewals[id % MaxRenewals] == id ? _sent[id % MaxRenewals] : double.NaN;
        }

        /// <summary>Records that a request was sent.</summary>
        public void Add(long id, PendingRequest request)
        {
            _pending.Add(id, request);
        }

        /// <summary>Removes and returns the request with this ID; null if there is none.</summary>
        public PendingRequest Take(long id)
        {
            PendingRequest request;
            if (_pending.TryGetValue(id, out request))
            {
                _pending.Remove(id);
            }
            return request;
        }

        /// <summary>Returns the name of a request whose answer is late; "" if there is none.</summary>
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

        /// <summary>Drops all requests: they will not be answered.</summary>
        public void Forget(Inbox inbox)
        {
            foreach (KeyValuePair<long, PendingRequest> pair in _pending)
            {
                inbox.AddAnswer(pair.Value, null);
            }
            _pending.Clear();
        }
    }
}
