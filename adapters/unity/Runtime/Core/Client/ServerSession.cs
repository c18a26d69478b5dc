using Pacinian.Wire;

namespace Pacinian
{
    /// <summary>
    /// One session with the server, from hello to bye; nothing of a lost session continues. This part sends messages; the
    /// others receive them, and decide when the session is lost. Never blocks, and does not read a clock: times are
    /// arguments [s].
    /// </summary>
    internal sealed partial class ServerSession
    {
        private const double RenewalShare = 0.125; // interval between renewals, as a fraction of the lease
        private const int Burst = 100; // commands that are sent before messages are received again

        private readonly SharedState _shared;
        private readonly ITransport _transport;
        private readonly MessageBuffers _buffers;
        private readonly UnansweredRequests _unanswered = new UnansweredRequests();
        private readonly ServerClock _serverClock = new ServerClock();
        private readonly string _at;
        private readonly double _begun;
        private SessionState _sessionState = SessionState.None(ClientStatus.Connected, "");
        private bool _greeted, _leaving;
        private double _renewed = double.NegativeInfinity;
        private Bulk _session;
        private long _sequence;

        /// <summary>buffers: for writing and reading. at: the server's address. session: its number, from 1 on.</summary>
        public ServerSession(SharedState shared, ITransport transport, MessageBuffers buffers, string at, int session, double now)
        {
            _shared = shared;
            _transport = transport;
            _buffers = buffers;
            _at = at;
            _begun = now;
            _sessionState.Session = session;
            Over = "";
        }

        /// <summary>Whether the session has begun.</summary>
        public bool Begun { get; private set; }

        /// <summary>Whether the server has answered the goodbye.</summary>
        public bool GoodbyeAnswered { get; private set; }

        /// <summary>Receives and sends messages. ticked: the time of the game's last tick.</summary>
        public void Step(double now, double ticked)
        {
            bool heard = ReceiveMessages(Channel.Control, now) | ReceiveMessages(Channel.Command, now);
            ReceiveState();
            CheckConnection(heard);
            if (Over.Length == 0)
            {
                SendMessages(now, ticked);
                CheckTimeouts(now);
            }
        }

        /// <summary>Says goodbye. Returns false if no server would answer.</summary>
        public bool SayGoodbye(double now)
        {
            if (!Begun || Over.Length > 0)
            {
                return false;
            }
            _leaving = true;
            return Send(new Bye { Session = _session, Id = _unanswered.NextId() });
        }

        private void SendMessages(double now, double ticked)
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
            if (ticked - _renewed >= RenewalShare * _sessionState.Lease)
            {
                Renew(now, ticked);
            }
            SendRequests(now);
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

        /// <summary>Renews the lease from the time of the game's tick, which may be earlier than now.</summary>
        private void Renew(double now, double ticked)
        {
            Renew renew = _buffers.Renew;
            renew.Session = _session;
            renew.Id = _unanswered.NextId();
            renew.Sequence = ++_sequence;
            renew.Time = _renewed = ticked;
            _unanswered.NoteRenewal(renew.Id, now);
            Send(renew);
        }

        private void SendRequests(double now)
        {
            PendingRequest request;
            while ((request = _shared.Requests.Next) != null && _transport.Room(request.Channel))
            {
                if (request.Resets && _shared.PendingStops.Any)
                {
                    return;
                }
                _shared.Requests.RemoveNext();
                long id = _unanswered.NextId();
                request.Write(_buffers.Writer, _session, id, ref _sequence, now);
                _unanswered.Add(id, request);
                _transport.Send(request.Channel, _buffers.Writer.Data, _buffers.Writer.Count);
            }
        }

        private Hello Hello()
        {
            Options options = _shared.Options;
            return new Hello
            {
                Id = _unanswered.NextId(),
                Protocol = new Int2(Protocol.Major, Protocol.Minor),
                Client = options.Name,
                Version = options.Version,
                Scene = options.Scene,
                Lease = options.Lease == 0.0 ? (double?)null : options.Lease,
            };
        }

        private bool Send(IMessage message)
        {
            _buffers.Writer.Clear();
            message.Write(_buffers.Writer);
            return _transport.Send(Channel.Control, _buffers.Writer.Data, _buffers.Writer.Count);
        }
    }
}
