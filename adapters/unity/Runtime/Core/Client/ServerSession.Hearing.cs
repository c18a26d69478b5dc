using System.Text;
using Pacinian.Wire;

namespace Pacinian
{
    /// <summary>What the server says.</summary>
    internal sealed partial class ServerSession
    {
        private const int Most = 1000; // messages that are read at once

        private double _greetedAt;
        private bool _unreadable;

        /// <summary>Takes in what has come on a socket; whether there was something.</summary>
        private bool Hear(Channel channel, double now)
        {
            int heard = 0;
            for (; heard < Most && Over.Length == 0; heard++)
            {
                int count = _transport.Receive(channel, _buffers.Data);
                if (count < 0)
                {
                    break;
                }
                if (Protocol.ReadReply(_buffers.Reader, _buffers.Data, 0, count, ref _buffers.Reply))
                {
                    Note(_buffers.Reply, now);
                }
                else
                {
                    Misread();
                }
            }
            return heard > 0;
        }

        /// <summary>The newest of the states that have come; those before are skipped.</summary>
        private void Look()
        {
            int newest = -1;
            for (int i = 0; i < Most; i++)
            {
                int count = _transport.Receive(Channel.State, _buffers.Spare);
                if (count < 0)
                {
                    break;
                }
                newest = count;
                _buffers.Swap();
            }
            if (newest < 0 || !Begun)
            {
                return;
            }
            IState state = _shared.Inbox.Back;
            if (Protocol.ReadState(_buffers.Reader, _buffers.Data, 0, newest, ref state) && state == _shared.Inbox.Back)
            {
                _shared.Inbox.Publish();
            }
            else
            {
                Misread();
            }
        }

        private void Note(IReply reply, double now)
        {
            if (reply is Renewed renewed)
            {
                Note(renewed, now);
            }
            else if (reply is Error error)
            {
                Note(error);
            }
            else if (reply is Ok ok)
            {
                Note(ok);
            }
            else if (reply is Welcome welcome)
            {
                Note(welcome, now);
            }
            else if (reply is Abilities abilities)
            {
                Note(abilities);
            }
            else if (reply is Pressures pressures)
            {
                Note(pressures);
            }
        }

        private void Note(Renewed renewed, double now)
        {
            _standing.Armed = renewed.Armed;
            _standing.Owner = renewed.Owner;
            if (renewed.Id != 0)
            {
                double sent = _table.TakeRenewal(renewed.Id);
                if (!double.IsNaN(sent))
                {
                    _timing.Answered(sent, now, renewed.ServerTime);
                    _shared.Inbox.Time(_timing.Trips, _timing.Offset);
                }
            }
            Stand();
        }

        private void Note(Ok ok)
        {
            PendingRequest request = _table.Take(ok.Id);
            Left |= _leaving && request == null;
            if (request != null && (request.Arms || request.LetsGo))
            {
                _standing.Armed = _standing.Owner = request.Arms;
                Stand();
            }
        }

        private void Note(Welcome welcome, double now)
        {
            if (welcome.Protocol.X != Protocol.Major)
            {
                Lose(Problems.Version(welcome.Protocol.X), true);
                return;
            }
            _session.Set(welcome.Session.Data, 0, welcome.Session.Count);
            _standing.Lease = welcome.Lease;
            _standing.Scene = welcome.Scene;
            _standing.Server = welcome.Server;
            _timing.Clocked(_greetedAt, now, welcome.Time);
            _shared.Inbox.Time(_timing.Trips, _timing.Offset);
            Send(new Capabilities { Session = _session, Id = _table.NextId() });
        }

        private void Note(Abilities abilities)
        {
            _buffers.Reply = null; // it is the game's from now on
            _standing.Abilities = abilities;
            Begun = true;
            _shared.Begin(_standing);
        }

        private void Note(Pressures pressures)
        {
            _buffers.Reply = null;
            PendingRequest request = _table.Take(pressures.Id);
            if (request != null)
            {
                _shared.Inbox.Answer(request, pressures);
            }
        }

        private void Note(Error error)
        {
            Refusal why = Problems.Of(error);
            if (!Begun)
            {
                Lose(why.ToString(), true);
            }
            else if (error.Code == Code.Session)
            {
                Lose(why.Message, false);
            }
            else if (error.Id == 0 && Problems.Ends(error.Code))
            {
                _standing.Armed = false;
                Stand();
                _shared.Inbox.Tell(new Notice { What = Happening.Ended, Why = why });
            }
            else
            {
                PendingRequest request = _table.Take(error.Id);
                if (request != null)
                {
                    _shared.Inbox.Answer(request, null);
                }
                _shared.Inbox.Refuse(why);
            }
        }

        private void Misread()
        {
            if (!_unreadable)
            {
                _unreadable = true;
                _shared.Inbox.Refuse(Problems.Unreadable(_buffers.Reader.Problem, _buffers.Reader.Path));
            }
        }

        private void Stand()
        {
            if (Begun)
            {
                _shared.Inbox.Stand(_standing);
            }
        }
    }
}
