using Pacinian.Wire;

namespace Pacinian
{
    /// <summary>
    /// One session with the server, from hello to bye: what is lost with it is not taken up again. Pure: times are
    /// given [s], and it never waits. Here is what is said; what is heard is in the other part.
    /// </summary>
    internal sealed partial class Dialogue
    {
        private const double Share = 0.125; // of the lease between two renewals
        private const int Burst = 100; // commands before it looks again at what has come

        private readonly Shared _shared;
        private readonly ITransport _transport;
        private readonly Desk _desk;
        private readonly Asking _asking = new Asking();
        private readonly Timing _timing = new Timing();
        private readonly string _at;
        private readonly double _begun;
        private Standing _standing = Standing.None(ClientStatus.Connected, "");
        private bool _greeted, _leaving;
        private double _renewed = double.NegativeInfinity;
        private Bulk _session;
        private long _sequence;

        /// <summary>desk: what it writes and reads with. at: the server's address. session: which it is, from 1 on.</summary>
        public Dialogue(Shared shared, ITransport transport, Desk desk, string at, int session, double now)
        {
            _shared = shared;
            _transport = transport;
            _desk = desk;
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
            if (Begun && (ending == Ending.Nobody || ending == Ending.Foreign))
            {
                ending = Ending.Gone; // in the middle of the handshake of another connection
            }
            if (ending != Ending.None && !heard)
            {
                Lose(Problems.Of(ending, _at), Problems.Refuses(ending));
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
            return Send(new Bye { Session = _session, Id = _asking.Number() });
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
                if (!_shared.Outbox.Take(_desk.Batch, now))
                {
                    return;
                }
                _desk.Commands.Write(_desk.Writer, _desk.Batch, _session, ++_sequence);
                _desk.Batch.GiveBack(_shared.Parts);
                _transport.Send(Channel.Command, _desk.Writer.Data, _desk.Writer.Count);
            }
        }

        /// <summary>The lease counts from the game's tick, not from when this is sent.</summary>
        private void Renew(double now, double ticked)
        {
            Renew renew = _desk.Renew;
            renew.Session = _session;
            renew.Id = _asking.Number();
            renew.Sequence = ++_sequence;
            renew.Time = _renewed = ticked;
            _asking.Renew(renew.Id, now);
            Send(renew);
        }

        private void Ask(double now)
        {
            Asked asked;
            while ((asked = _shared.Requests.Next) != null && _transport.Room(asked.Channel))
            {
                if (asked.Resets && _shared.Beat.Stopping)
                {
                    return;
                }
                _shared.Requests.Done();
                long id = _asking.Number();
                asked.Write(_desk.Writer, _session, id, ref _sequence, now);
                _asking.Add(id, asked);
                _transport.Send(asked.Channel, _desk.Writer.Data, _desk.Writer.Count);
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
            string late = _asking.Late(now, timeout);
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
                Id = _asking.Number(),
                Protocol = new Int2(Protocol.Major, Protocol.Minor),
                Client = options.Name,
                Version = options.Version,
                Scene = options.Scene,
                Lease = options.Lease > 0.0 ? options.Lease : (double?)null,
            };
        }

        private bool Send(IMessage message)
        {
            _desk.Writer.Clear();
            message.Write(_desk.Writer);
            return _transport.Send(Channel.Control, _desk.Writer.Data, _desk.Writer.Count);
        }

        private void Lose(string why, bool refused)
        {
            if (Over.Length > 0)
            {
                return;
            }
            Over = why + (Begun ? Problems.Nothing : "");
            Refused = refused;
            _asking.Forget(_shared.News);
        }
    }
}
