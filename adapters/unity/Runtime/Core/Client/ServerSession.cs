using Pacinian.Wire;

namespace Pacinian
{
    /// <summary>
    /// One session with the server, from hello to bye: what is lost with it is not taken up again. Pure: times are
    /// given [s], and it never waits. Here is what is said; what is heard is in the other part.
    /// </summary>
    internal sealed partial class ServerSession
    {
        private const double Share = 0.125; // of the lease between two renewals
        private const int Burst = 100; // commands before it looks again at what has come

        private readonly SharedState _shared;
        private readonly ITransport _transport;
        private readonly MessageBuffers _buffers;
        private readonly RequestTable _table = new RequestTable();
        private readonly Timing _timing = new Timing();
        private readonly string _at;
        private readonly double _begun;
        private Standing _standing = Standing.None(ClientStatus.Connected, "");
        private bool _greeted, _leaving;
        private double _renewed = double.NegativeInfinity;
        private Bulk _session;
        private long _sequence;

        /// <summary>buffers: what it writes and reads with. at: the server's address. session: which it is, from 1 on.</summary>
        public ServerSession(SharedState shared, ITransport transport, MessageBuffers buffers, string at, int session, double now)
        {
            _shared = shared;
            _transport = transport;
            _buffers = buffers;
            _at = at;
            _begun = now;
            _standing.Session = session;
            Over = "";
        }

        /// <summary>Why it is over; "" while it is not.</summary>
        public string Over { get; private set; }

        /// <summary>Whether it is over because the server will not have us.</summary>
        public bool Refused { get; private set; }

        /// <summary>Whether there is, or was, a session.</summary>
        public bool Begun { get; private set; }

        /// <summary>Whether the goodbye was answered.</summary>
        public bool Left { get; private set; }

        /// <summary>Does what is due. ticked: when the game ticked last.</summary>
        public void Step(double now, double ticked)
        {
            bool heard = Hear(Channel.Control, now) | Hear(Channel.Command, now);
            Look();
            Ending ending = _transport.Ended();
            string why = _transport.Problem;
            if (Begun && (ending == Ending.Nobody || ending == Ending.Foreign))
            {
                ending = Ending.Gone; // in the middle of the handshake of another connection
                why = "";
            }
            if (ending != Ending.None && !heard)
            {
                Lose(Problems.Of(ending, _at, why), Problems.Refuses(ending));
            }
            if (Over.Length == 0)
            {
                Speak(now, ticked);
                Check(now);
            }
        }

        /// <summary>Says goodbye; false if there is nobody who would answer.</summary>
        public bool Leave(double now)
        {
            if (!Begun || Over.Length > 0)
            {
                return false;
            }
            _leaving = true;
            return Send(new Bye { Session = _session, Id = _table.NextId() });
        }

        private void Speak(double now, double ticked)
        {
            if (!_greeted)
            {
                _greeted = _transport.Room(Channel.Control) && Send(Hello());
                _greetedAt = now;
            }
            if (!Begun || _leaving)
            {
                return;
            }
            if (ticked - _renewed >= Share * _standing.Lease)
            {
                Renew(now, ticked);
            }
            Ask(now);
            for (int i = 0; i < Burst && _transport.Room(Channel.Command); i++)
            {
                if (!_shared.Outbox.Take(_buffers.Batch, now))
                {
                    return;
                }
                _buffers.Commands.Write(_buffers.Writer, _buffers.Batch, _session, ++_sequence);
                _buffers.Batch.Return(_shared.Writers);
                _transport.Send(Channel.Command, _buffers.Writer.Data, _buffers.Writer.Count);
            }
        }

        /// <summary>The lease counts from the game's tick, not from when this is sent.</summary>
        private void Renew(double now, double ticked)
        {
            Renew renew = _buffers.Renew;
            renew.Session = _session;
            renew.Id = _table.NextId();
            renew.Sequence = ++_sequence;
            renew.Time = _renewed = ticked;
            _table.NoteRenewal(renew.Id, now);
            Send(renew);
        }

        private void Ask(double now)
        {
            PendingRequest request;
            while ((request = _shared.Requests.Next) != null && _transport.Room(request.Channel))
            {
                if (request.Resets && _shared.PendingStops.Any)
                {
                    return;
                }
                _shared.Requests.RemoveNext();
                long id = _table.NextId();
                request.Write(_buffers.Writer, _session, id, ref _sequence, now);
                _table.Add(id, request);
                _transport.Send(request.Channel, _buffers.Writer.Data, _buffers.Writer.Count);
            }
        }

        private void Check(double now)
        {
            double timeout = _shared.Options.Timeout;
            if (!Begun && now - _begun > timeout)
            {
                Lose(Problems.Hangs("hello", timeout), false);
                return;
            }
            string late = _table.FindLate(now, timeout);
            if (late.Length > 0)
            {
                Lose(Problems.Hangs(late, timeout), false);
            }
        }

        private Hello Hello()
        {
            Options options = _shared.Options;
            return new Hello
            {
                Id = _table.NextId(),
                Protocol = new Int2(Protocol.Major, Protocol.Minor),
                Client = options.Name,
                Version = options.Version,
                Scene = options.Scene,
                Lease = options.Lease > 0.0 ? options.Lease : (double?)null,
            };
        }

        private bool Send(IMessage message)
        {
            _buffers.Writer.Clear();
            message.Write(_buffers.Writer);
            return _transport.Send(Channel.Control, _buffers.Writer.Data, _buffers.Writer.Count);
        }

        private void Lose(string why, bool refused)
        {
            if (Over.Length > 0)
            {
                return;
            }
            Over = why + (Begun ? Problems.Nothing : "");
            Refused = refused;
            _table.Forget(_shared.Inbox);
        }
    }
}
