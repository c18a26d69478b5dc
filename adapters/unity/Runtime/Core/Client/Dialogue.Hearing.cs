using System.Text;
using Pacinian.Wire;

namespace Pacinian
{
    /// <summary>What the server says.</summary>
    internal sealed partial class Dialogue
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
                int count = _transport.Receive(channel, _desk.Data);
                if (count < 0)
                {
                    break;
                }
                if (Protocol.ReadReply(_desk.Reader, _desk.Data, 0, count, ref _desk.Reply))
                {
                    Note(_desk.Reply, now);
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
                int count = _transport.Receive(Channel.State, _desk.Spare);
                if (count < 0)
                {
                    break;
                }
                newest = count;
                _desk.Swap();
            }
            if (newest < 0 || !Begun)
            {
                return;
            }
            IState state = _shared.News.Back;
            if (Protocol.ReadState(_desk.Reader, _desk.Data, 0, newest, ref state) && state == _shared.News.Back)
            {
                _shared.News.Publish();
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
                double sent = _asking.Renewed(renewed.Id);
                if (!double.IsNaN(sent))
                {
                    _timing.Answered(sent, now, renewed.ServerTime);
                    _shared.News.Time(_timing.Trips, _timing.Offset);
                }
            }
            Stand();
        }

        private void Note(Ok ok)
        {
            Asked asked = _asking.Take(ok.Id);
            Left |= _leaving && asked == null;
            if (asked != null && (asked.Arms || asked.LetsGo))
            {
                _standing.Armed = _standing.Owner = asked.Arms;
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
            _shared.News.Time(_timing.Trips, _timing.Offset);
            Send(new Capabilities { Session = _session, Id = _asking.Number() });
        }

        private void Note(Abilities abilities)
        {
            _desk.Reply = null; // it is the game's from now on
            _standing.Abilities = abilities;
            Begun = true;
            _shared.Begin(_standing);
        }

        private void Note(Pressures pressures)
        {
            _desk.Reply = null;
            Asked asked = _asking.Take(pressures.Id);
            if (asked != null)
            {
                _shared.News.Answer(asked, pressures);
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
                _shared.News.Tell(new Notice { What = Happening.Ended, Why = why });
            }
            else
            {
                Asked asked = _asking.Take(error.Id);
                if (asked != null)
                {
                    _shared.News.Answer(asked, null);
                }
                _shared.News.Refuse(why);
            }
        }

        private void Misread()
        {
            if (!_unreadable)
            {
                _unreadable = true;
                _shared.News.Refuse(Problems.Unreadable(_desk.Reader.Problem, _desk.Reader.Path));
            }
        }

        private void Stand()
        {
            if (Begun)
            {
                _shared.News.Stand(_standing);
            }
        }
    }
}
