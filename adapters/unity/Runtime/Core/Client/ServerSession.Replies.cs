using System.Text;
using Pacinian.Wire;

namespace Pacinian
{
    /// <summary>Receives the server's messages.</summary>
    internal sealed partial class ServerSession
    {
        private const int MaxMessagesAtOnce = 1000; // messages that are read in one step

        private double _greetedAt;
        private bool _unreadable;

        /// <summary>Handles the messages of a socket. Returns whether there were any.</summary>
        private bool ReceiveMessages(Channel channel, double now)
        {
            int heard = 0;
            for (; heard < MaxMessagesAtOnce && Over.Length == 0; heard++)
            {
                int count = _transport.Receive(channel, _buffers.Data);
                if (count < 0)
                {
                    break;
                }
                if (Protocol.ReadReply(_buffers.Reader, _buffers.Data, 0, count, ref _buffers.Reply))
                {
                    Handle(_buffers.Reply, now);
                }
                else
                {
                    ReportUnreadable();
                }
            }
            return heard > 0;
        }

        /// <summary>Publishes the newest state that has arrived; skips the older ones.</summary>
        private void ReceiveState()
        {
            int newest = -1;
            for (int i = 0; i < MaxMessagesAtOnce; i++)
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
                _shared.Inbox.PublishState();
            }
            else
            {
                ReportUnreadable();
            }
        }

        private void Handle(IReply reply, double now)
        {
            if (reply is Renewed renewed)
            {
                Handle(renewed, now);
            }
            else if (reply is Error error)
            {
                Handle(error);
            }
            else if (reply is Ok ok)
            {
                Handle(ok);
            }
            else if (reply is Welcome welcome)
            {
                Handle(welcome, now);
            }
            else if (reply is Abilities abilities)
            {
                Handle(abilities);
            }
            else if (reply is Pressures pressures)
            {
                Handle(pressures);
            }
        }

        private void Handle(Renewed renewed, double now)
        {
            _sessionState.Armed = renewed.Armed;
            _sessionState.Owner = renewed.Owner;
            if (renewed.Id != 0)
            {
                double sent = _unanswered.TakeRenewal(renewed.Id);
                if (!double.IsNaN(sent))
                {
                    _serverClock.AddRoundTrip(sent, now);
                    _serverClock.AddMark(sent, now, renewed.ServerTime);
                    _shared.Inbox.SetServerClock(_serverClock.RoundTrips, _serverClock.Offset);
                }
            }
            PublishStatus();
        }

        private void Handle(Ok ok)
        {
            PendingRequest request = _unanswered.Take(ok.Id);
            GoodbyeAnswered |= _leaving && request == null;
            if (request != null && (request.Arms || request.LetsGo))
            {
                _sessionState.Armed = _sessionState.Owner = request.Arms;
                PublishStatus();
            }
        }

        private void Handle(Welcome welcome, double now)
        {
            if (welcome.Protocol.X != Protocol.Major)
            {
                SetLost(ErrorMessages.Version(welcome.Protocol.X), true);
                return;
            }
            _session.Set(welcome.Session.Data, 0, welcome.Session.Count);
            _sessionState.Lease = welcome.Lease;
            _sessionState.Scene = welcome.Scene;
            _sessionState.Server = welcome.Server;
            _serverClock.AddMark(_greetedAt, now, welcome.Time);
            _shared.Inbox.SetServerClock(_serverClock.RoundTrips, _serverClock.Offset);
            Send(new Capabilities { Session = _session, Id = _unanswered.NextId() });
        }

        private void Handle(Abilities abilities)
        {
            _buffers.Reply = null; // the game uses it from now on
            _sessionState.Abilities = abilities;
            Begun = true;
            _shared.StartSession(_sessionState);
        }

        private void Handle(Pressures pressures)
        {
            _buffers.Reply = null;
            PendingRequest request = _unanswered.Take(pressures.Id);
            if (request != null)
            {
                _shared.Inbox.AddAnswer(request, pressures);
            }
        }

        private void Handle(Error error)
        {
            Refusal why = ErrorMessages.MakeRefusal(error);
            if (!Begun)
            {
                SetLost(why.ToString(), true);
            }
            else if (error.Code == Code.Session)
            {
                SetLost(why.Message, false);
            }
            else if (error.Id == 0 && EndsSound(error.Code))
            {
                _sessionState.Armed = false;
                PublishStatus();
                _shared.Inbox.AddEvent(new ClientEvent { What = ClientEventKind.Ended, Why = why });
            }
            else
            {
                PendingRequest request = _unanswered.Take(error.Id);
                if (request != null)
                {
                    _shared.Inbox.AddAnswer(request, null);
                }
                _shared.Inbox.AddRefusal(why);
            }
        }

        /// <summary>Returns whether an error ends the sound of an owner unasked.</summary>
        private static bool EndsSound(Code code)
        {
            return code == Code.Expired || code == Code.Owner || code == Code.Fault || code == Code.Stopped;
        }

        private void ReportUnreadable()
        {
            if (!_unreadable)
            {
                _unreadable = true;
                _shared.Inbox.AddRefusal(ErrorMessages.Unreadable(_buffers.Reader.Problem, _buffers.Reader.Path));
            }
        }

        private void PublishStatus()
        {
            if (Begun)
            {
                _shared.Inbox.SetSessionState(_sessionState);
            }
        }
    }
}
