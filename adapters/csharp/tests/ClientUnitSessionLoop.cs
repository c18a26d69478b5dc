using System;
using System.Collections.Generic;
using Pacinian.Wire;

namespace Pacinian.Tests
{
    /// <summary>Tests of sessions, with a scripted transport and a clock that the test sets.</summary>
    internal sealed class ClientUnitSessions
    {
        private readonly Scripted _wire = new Scripted();
        private readonly SharedState _shared = new SharedState(new Options());
        private readonly SessionLoop _sessionLoop;
        private string _problem = "";
        private double _now = 100.0;

        public ClientUnitSessions()
        {
            _sessionLoop = new SessionLoop(_shared, _wire, (string path, out string problem) =>
            {
                problem = _problem;
                return new ConnectionFile { Control = "here" };
            });
        }

        public void ItTriesAgainWithGrowingPauses()
        {
            _problem = "no file";
            Pauses(0.1, 0.2, 0.4, 0.5, 0.5);
            _problem = "";
            _wire.End = Ending.Nobody;
            Pauses(0.1, 0.2, 0.4, 0.8, 1.6, 2.0, 2.0);
            ClientUnit.Equal(ClientStatus.Connecting, _shared.Inbox.SessionState.Status);
            _wire.End = Ending.Denied;
            Pauses(0.1);
            ClientUnit.Equal(ClientStatus.Refused, _shared.Inbox.SessionState.Status);
            ClientUnit.Holds(_shared.Inbox.SessionState.Problem.Contains("token or key"));
            ClientUnit.Equal("", TakeNotices());
        }

        public void ItIsConnectedWhenTheServerHasSaidWhatItCan()
        {
            Connect();
            SessionState sessionState = _shared.Inbox.SessionState;
            ClientUnit.Equal("hall", sessionState.Scene);
            ClientUnit.Equal(1, sessionState.Session);
            ClientUnit.Holds(!sessionState.Armed && sessionState.Abilities != null && sessionState.Problem == "");
            ClientUnit.Equal("Connected", TakeNotices());
            ClientUnit.Equal("Hello Capabilities", _wire.Said());
        }

        public void NoAnswerToHelloIsTold()
        {
            Step(0.0);
            Step(2.01);
            ClientUnit.Holds(_shared.Inbox.SessionState.Problem.Contains("no answer to `hello` within 2 s"));
            ClientUnit.Equal("", TakeNotices());
        }

        public void ItRenewsOnlyWhenTheGameHasTicked()
        {
            Connect();
            _wire.Said();
            Step(0.01);
            ClientUnit.Equal("", _wire.Said());
            double ticked = _now;
            _shared.Heartbeat.LastTick = ticked;
            Step(0.005);
            ClientUnit.Near(ticked, ((Renew)_wire.Last).Time); // not the time of sending
            Answer(new Renewed { Id = 3, Owner = true, Armed = true, ServerTime = _now });
            Step(0.001);
            ClientUnit.Holds(_shared.Inbox.SessionState.Armed);
            _shared.Heartbeat.LastTick = ticked + 0.01; // soon after
            Step(0.01);
            _shared.Heartbeat.LastTick = ticked + 0.04;
            Step(0.03);
            ClientUnit.Equal("Renew Renew", _wire.Said());
            for (int i = 0; i < 100; i++)
            {
                Step(0.01);
            }
            ClientUnit.Equal("", _wire.Said());
        }

        public void AServerThatWasThereHasGoneWhateverItsOtherConnectionsSay()
        {
            foreach (Ending ending in new[] { Ending.Nobody, Ending.Foreign, Ending.Gone })
            {
                _wire.End = Ending.None;
                _now += 3.0;
                Connect();
                _wire.End = ending;
                Step(0.001);
                ClientUnit.Holds(_shared.Inbox.SessionState.Problem.Contains("has gone; nothing of this session goes on"));
                ClientUnit.Equal(ClientStatus.Connecting, _shared.Inbox.SessionState.Status);
            }
        }

        public void WhyAConnectionHasEndedIsTold()
        {
            _wire.End = Ending.Foreign;
            _wire.Why = "the peer wants another mechanism";
            Step(0.0);
            ClientUnit.Holds(_shared.Inbox.SessionState.Problem.EndsWith("or is too busy: the peer wants another mechanism"));
        }

        public void SessionsThatEndedBetweenTwoTicksAreNotTold()
        {
            Connect();
            Lose();
            ClientUnit.Equal("", TakeNotices());
            Connect();
            ClientUnit.Equal("Connected", TakeNotices());
            Lose();
            Connect();
            Lose();
            Connect();
            ClientUnit.Equal("Lost Connected", TakeNotices());
        }

        public void AfterALossNothingResumes()
        {
            Connect();
            TakeNotices();
            Movement movement = new Movement();
            _shared.Requests.Add(1, new PendingRequest("arm", new Arm(), 2.0));
            Step(0.001);
            Answer(new Ok { Id = 3 });
            Step(0.001);
            ClientUnit.Holds(_shared.Inbox.SessionState.Armed);
            _wire.Full = true;
            _shared.Outbox.Write(1, Kind.Move, "a", null, ref movement, _now);
            _shared.Requests.Add(1, new PendingRequest("field", new Field(), 2.0, answer => { }));
            _wire.End = Ending.Gone;
            Step(0.001);
            ClientUnit.Holds(_shared.Inbox.SessionState.Problem.Contains("has gone; nothing of this session goes on"));
            ClientUnit.Holds(!_shared.Inbox.SessionState.Armed && _shared.Inbox.SessionState.Session == 0);
            ClientUnit.Equal("Answered Lost", TakeNotices());
            ClientUnit.Holds(!_shared.Outbox.Write(1, Kind.Move, "a", null, ref movement, _now));
            _wire.End = Ending.None;
            _wire.Full = false;
            _wire.Said();
            _now += 0.11;
            Connect();
            Step(0.001);
            ClientUnit.Equal("Hello Capabilities", _wire.Said());
            ClientUnit.Equal(2, _shared.Inbox.SessionState.Session);
            ClientUnit.Holds(!_shared.Inbox.SessionState.Armed);
        }

        public void WhatCameBeforeTheEndIsHeard()
        {
            Connect();
            TakeNotices();
            Answer(new Error { Code = Code.Expired, Message = "late" });
            _wire.End = Ending.Gone;
            Step(0.001);
            ClientUnit.Equal("Ended", TakeNotices());
            Step(0.001);
            ClientUnit.Equal("Lost", TakeNotices());
        }

        public void AResetWaitsForAStop()
        {
            Connect();
            _wire.Said();
            _shared.PendingStops.Begin();
            _shared.Requests.Add(1, new PendingRequest("reset", new Reset(), 2.0));
            Step(0.001);
            ClientUnit.Equal("", _wire.Said());
            _shared.PendingStops.End();
            Step(0.001);
            ClientUnit.Equal("Reset", _wire.Said());
        }

        public void ItSaysGoodbye()
        {
            ClientUnit.Holds(!_sessionLoop.SayGoodbye(_now) && _sessionLoop.GoodbyeAnswered);
            Connect();
            _wire.Said();
            ClientUnit.Holds(_sessionLoop.SayGoodbye(_now) && !_sessionLoop.GoodbyeAnswered);
            _shared.Heartbeat.LastTick = _now;
            Step(0.001);
            ClientUnit.Equal("Bye", _wire.Said());
            Answer(new Ok { Id = 3 });
            Step(0.001);
            ClientUnit.Holds(_sessionLoop.GoodbyeAnswered);
        }

        private void Connect()
        {
            Step(0.0);
            Welcome welcome = new Welcome { Id = 1, Protocol = new Int2(1, 7), Server = "s", Scene = "hall", Lease = 0.25 };
            welcome.Session.Set(new byte[Protocol.SessionBytes], 0, Protocol.SessionBytes);
            Answer(welcome);
            Step(0.001);
            Answer(new Abilities { Id = 2 });
            Step(0.001);
            ClientUnit.Equal(ClientStatus.Connected, _shared.Inbox.SessionState.Status);
        }

        private void Lose()
        {
            _wire.End = Ending.Gone;
            Step(0.001);
            _wire.End = Ending.None;
            _now += 0.11;
        }

        private void Pauses(params double[] wanted)
        {
            foreach (double pause in wanted)
            {
                int opened = _wire.Opened;
                Step(0.0);
                ClientUnit.Equal(_problem.Length > 0 ? opened : opened + 1, _wire.Opened);
                Step(pause - 0.001);
                ClientUnit.Near(Math.Min(0.05, 0.001), _sessionLoop.MaxWait(_now), 1e-6);
                _now += 0.0011;
            }
        }

        private void Step(double seconds)
        {
            _now += seconds;
            _sessionLoop.Step(_now, _shared.Heartbeat.LastTick);
        }

        private void Answer(IMessage message)
        {
            _wire.Answers.Enqueue(message);
        }

        private string TakeNotices()
        {
            List<string> all = new List<string>();
            ClientEvent clientEvent;
            SessionState sessionState = new SessionState();
            while (_shared.Inbox.TakeEvent(out clientEvent, ref sessionState))
            {
                all.Add(clientEvent.What.ToString());
            }
            return string.Join(" ", all.ToArray());
        }
    }
}
