using System;
using Pacinian.Wire;

namespace Pacinian.Tests
{
    /// <summary>Tests of round trips, clocks, requests and events.</summary>
    internal sealed class ClientUnitParts
    {
        public void RoundTripsAndTheServersClock()
        {
            ServerClock clock = new ServerClock();
            ClientUnit.Equal(0.0, clock.Offset);
            ClientUnit.Equal(0.0, clock.RoundTrips.Median);
            for (int i = 1; i <= 100; i++)
            {
                clock.AddRoundTrip(i, i + 0.001 * i);
                clock.AddMark(i, i + 0.001 * i, i + 5.0 + 0.0005 * i);
            }
            ClientUnit.Near(0.051, clock.RoundTrips.Median, 1e-9);
            ClientUnit.Near(0.099, clock.RoundTrips.P99, 1e-9);
            ClientUnit.Near(0.100, clock.RoundTrips.Longest, 1e-9);
            ClientUnit.Near(5.0, clock.Offset, 1e-9);
            clock.AddMark(200.0, 200.0001, 300.0);
            ClientUnit.Near(99.99995, clock.Offset, 1e-9); // the shortest recent one
            for (int i = 0; i < 2000; i++)
            {
                clock.AddRoundTrip(i, i + 0.5);
                clock.AddMark(i, i + 0.5, i);
            }
            ClientUnit.Near(0.5, clock.RoundTrips.Median, 1e-9); // older ones are dropped
            ClientUnit.Near(-0.25, clock.Offset, 1e-9);
        }

        public void TheLastNumbersAreSorted()
        {
            SortedWindow sorted = new SortedWindow(50);
            double[] last = new double[50];
            Random random = new Random(1);
            for (int i = 0; i < 1000; i++)
            {
                last[i % 50] = random.Next(20);
                sorted.Add(last[i % 50]);
                double[] wanted = new double[Math.Min(i + 1, 50)];
                Array.Copy(last, wanted, wanted.Length);
                Array.Sort(wanted);
                ClientUnit.Equal(wanted.Length, sorted.Count);
                for (int j = 0; j <= 10; j++)
                {
                    ClientUnit.Equal(wanted[(int)Math.Round(0.1 * j * (wanted.Length - 1))], sorted.Quantile(0.1 * j));
                }
            }
        }

        public void WhatIsAskedIsAnsweredInTimeOrLate()
        {
            UnansweredRequests unanswered = new UnansweredRequests();
            Writer writer = new Writer();
            long sequence = 0;
            ClientUnit.Equal("", unanswered.FindLate(1e9, 2.0));
            PendingRequest arm = new PendingRequest("arm", new Arm(), 2.0);
            long id = unanswered.NextId();
            arm.Write(writer, new Bulk(), id, ref sequence, 10.0);
            unanswered.Add(id, arm);
            ClientUnit.Equal("", unanswered.FindLate(12.0, 2.0));
            ClientUnit.Equal("arm", unanswered.FindLate(12.1, 2.0));
            ClientUnit.Holds(unanswered.Take(id) == arm);
            ClientUnit.Holds(unanswered.Take(id) == null);
            long first = unanswered.NextId(), second = unanswered.NextId();
            unanswered.NoteRenewal(first, 20.0);
            unanswered.NoteRenewal(second, 21.0);
            ClientUnit.Equal("renew", unanswered.FindLate(22.1, 2.0));
            ClientUnit.Equal(20.0, unanswered.TakeRenewal(first));
            ClientUnit.Equal("", unanswered.FindLate(1e9, 2.0));
            ClientUnit.Holds(double.IsNaN(unanswered.TakeRenewal(12345)));
        }

        public void ATextThatComesBackIsNotMadeAgain()
        {
            Reader reader = new Reader();
            Writer writer = new Writer();
            string[] words = { "limited", "deadline", "", "\u00e9\U0001F600", "limited!" };
            string[] first = new string[words.Length];
            string value = null;
            for (int i = 0; i < 100; i++)
            {
                writer.Clear();
                writer.Text(words[i % words.Length]);
                reader.Start(writer.Data, 0, writer.Count);
                ClientUnit.Holds(reader.Text(ref value) && reader.End());
                ClientUnit.Equal(words[i % words.Length], value);
                first[i % words.Length] = first[i % words.Length] ?? value;
                ClientUnit.Holds(ReferenceEquals(first[i % words.Length], value));
            }
            for (int i = 0; i < 100; i++) // more than it keeps, and longer ones
            {
                string text = new string('x', i);
                writer.Clear();
                writer.Text(text);
                reader.Start(writer.Data, 0, writer.Count);
                ClientUnit.Holds(reader.Text(ref value));
                ClientUnit.Equal(text, value);
            }
        }

        public void NumbersGoRoundWithoutZero()
        {
            UnansweredRequests unanswered = new UnansweredRequests();
            long last = 0;
            for (int i = 0; i < 1000; i++)
            {
                long number = unanswered.NextId();
                ClientUnit.Holds(number == last + 1);
                last = number;
            }
        }

        public void RequestsWaitForTheirSessionOnly()
        {
            Inbox inbox = new Inbox();
            UnsentRequests requests = new UnsentRequests();
            PendingRequest request = new PendingRequest("field", new Field(), 2.0, answer => { });
            ClientUnit.Holds(!requests.Add(0, request));
            requests.Open(1, inbox);
            ClientUnit.Holds(!requests.Add(2, request));
            ClientUnit.Holds(requests.Add(1, request));
            ClientUnit.Holds(requests.Next == request && requests.Next == request);
            requests.Open(2, inbox);
            ClientUnit.Holds(requests.Next == null);
            ClientEvent clientEvent;
            SessionState sessionState = new SessionState();
            ClientUnit.Holds(inbox.TakeEvent(out clientEvent, ref sessionState)); // the caller of the request is notified
            ClientUnit.Equal(ClientEventKind.Answered, clientEvent.What);
            ClientUnit.Holds(clientEvent.Answer == null);
        }

        public void TheNewestStateIsReadUntilTheNextLook()
        {
            Inbox inbox = new Inbox();
            SessionState sessionState;
            RoundTrips roundTrips;
            double offset;
            ClientUnit.Holds(inbox.Read == null);
            for (int i = 1; i <= 9; i++)
            {
                inbox.Back.Sequence = i;
                inbox.PublishState();
                bool looks = i % 3 == 0;
                if (looks)
                {
                    ClientUnit.Holds(inbox.TakeState(out sessionState, out roundTrips, out offset));
                    ClientUnit.Holds(!inbox.TakeState(out sessionState, out roundTrips, out offset));
                }
                ClientUnit.Equal(i / 3 * 3, inbox.Read == null ? 0 : (int)inbox.Read.Sequence);
                ClientUnit.Holds(inbox.Read != inbox.Back);
            }
            inbox.PublishState();
            inbox.SetSessionState(new SessionState { Session = 2 });
            ClientUnit.Holds(inbox.Read != null); // valid until the next look
            ClientUnit.Holds(!inbox.TakeState(out sessionState, out roundTrips, out offset));
            ClientUnit.Holds(inbox.Read == null); // states of another session are not read
        }

        public void OfTooManyNoticesTheNewestStay()
        {
            Inbox inbox = new Inbox();
            for (int i = 0; i < 3000; i++)
            {
                inbox.AddRefusal(new Refusal { Message = i.ToString() });
            }
            ClientEvent clientEvent;
            SessionState sessionState = new SessionState();
            int count = 0;
            string last = "";
            while (inbox.TakeEvent(out clientEvent, ref sessionState))
            {
                last = clientEvent.Why.Message;
                count++;
            }
            ClientUnit.Equal(1000, count);
            ClientUnit.Equal("2999", last);
        }

        public void KeysAreReadAsTheStandardHasThem()
        {
            byte[] key;
            ClientUnit.Holds(Z85.Read("rq:rM>}U?@Lns47E1%kR.o@n%FcmmsL/@{H8]yf7", out key)); // from ZeroMQ's RFC 26
            ClientUnit.Equal(
                "54FCBA24E93249969316FB617C872BB0C1D1FF14800427C594CBFACF1BC2D652",
                BitConverter.ToString(key).Replace("-", ""));
            foreach (string wrong in new[] { "", "short", new string('~', 40), new string('#', 40) })
            {
                ClientUnit.Holds(!Z85.Read(wrong, out key));
            }
        }

        public void WhatIsFeltIsReadWithoutGarbage()
        {
            State state = new State { Output = Output.Sounding };
            foreach (string name in new[] { "point", "ball", "plate" })
            {
                state.Objects.Add(name);
            }
            foreach (float figure in new[] { float.NaN, float.NaN, float.NaN, float.NaN, 0.98f, 0.06f, 0f, 1.3f, 1f, 0.5f, 0.25f, 0.125f })
            {
                state.Felt.Add(figure);
            }
            RegionFelt felt = new RegionFelt();
            long begin = 0;
            for (int i = 0; i < 100; i++)
            {
                begin = i == 10 ? GC.GetAllocatedBytesForCurrentThread() : begin;
                felt = RegionFelt.Of(state, "plate");
            }
            ClientUnit.Equal(0L, GC.GetAllocatedBytesForCurrentThread() - begin);
            ClientUnit.Equal(0.125f, felt.Spill);
            ClientUnit.Equal("force 98 %, rms error 6 %, holes 0 %, beside it 130 %", RegionFelt.Of(state, "ball").ToString());
            ClientUnit.Equal("not known", RegionFelt.Of(state, "point").ToString());
            ClientUnit.Holds(!RegionFelt.Of(state, "gone").Known && !RegionFelt.Of(null, "ball").Known);
            state.Output = Output.Silent;
            ClientUnit.Holds(!RegionFelt.Of(state, "ball").Known);
            state.Output = Output.Sounding;
            state.Felt.Add(1f); // not four numbers for each object
            ClientUnit.Holds(!RegionFelt.Of(state, "ball").Known);
        }

        public void PlacesAreToldByTheirNumbers()
        {
            ClientUnit.Equal("(0.1, -2, 30)", new Vec3(0.1, -2.0, 30.0).ToString());
        }

        public void ProblemsSayWhatToDo()
        {
            ClientUnit.Holds(ErrorMessages.Version(2).EndsWith("update the client", StringComparison.Ordinal));
            ClientUnit.Holds(ErrorMessages.Version(0).EndsWith("update the server", StringComparison.Ordinal));
            Refusal why = ErrorMessages.MakeRefusal(new Error { Code = Code.Version, Message = "no" });
            string ours = Protocol.Major + "." + Protocol.Minor;
            ClientUnit.Equal("version: no; update the older of the two: this client speaks " + ours, why.ToString());
            ClientUnit.Holds(ErrorMessages.DescribeException(new DllNotFoundException("libzmq")).Contains("not installed"));
        }
    }
}
