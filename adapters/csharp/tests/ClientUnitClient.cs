using System;
using System.Threading;
using Pacinian.Wire;

namespace Pacinian.Tests
{
    /// <summary>Tests of a client without a server.</summary>
    internal sealed class ClientUnitClient
    {
        private static readonly Options Nobody = new Options { ConnectionPath = "/nonexistent/connection.json", Timeout = 0.1 };

        public void AStopThatIsNotConfirmedIsToldWithoutASession()
        {
            HapticClient client = new HapticClient(Nobody);
            string seen = "";
            client.Refused += why => seen = why.ToString();
            for (int i = 0; i < 2; i++)
            {
                string told = "";
                using (ManualResetEvent done = new ManualResetEvent(false))
                {
                    client.Stop(why =>
                    {
                        told = why.ToString();
                        done.Set();
                    });
                    ClientUnit.Holds(done.WaitOne(60000));
                }
                ClientUnit.Holds(told.Contains("the stop was not confirmed") && told.Contains("switch the array off"));
                seen = "";
                client.Tick();
                ClientUnit.Equal(told, seen);
                client.Dispose(); // the second one is told afterwards
            }
        }

        public void AHandlerMayThrow()
        {
            using (HapticClient client = new HapticClient(Nobody))
            {
                int told = 0;
                client.Refused += why =>
                {
                    told++;
                    throw new InvalidOperationException("of the game");
                };
                client.Put("", new Point { RadiationPressure = 1.0 });
                client.Put("\uD800", new Point { RadiationPressure = 1.0 });
                ClientUnit.Raises<InvalidOperationException>(client.Tick);
                ClientUnit.Raises<InvalidOperationException>(client.Tick);
                client.Tick();
                ClientUnit.Equal(2, told);
            }
        }

        public void BeforeTheFirstTickTheThreadThatCallsFirstCounts()
        {
            using (HapticClient client = new HapticClient(Nobody))
            {
                string codes = "";
                client.Refused += why => codes += why.Code + " ";
                bool done = client.Arm();
                Thread other = new Thread(() => done |= client.Arm());
                other.Start();
                other.Join();
                client.Tick();
                ClientUnit.Holds(!done);
                ClientUnit.Equal("session thread ", codes);
            }
        }

        public void ANameIsText()
        {
            string name = "";
            for (int i = 0; i < 64; i++)
            {
                name += "\uD83D\uDE00";
            }
            ClientUnit.Holds(ObjectValidation.IsName(name));
            foreach (string wrong in new[] { name + "a", "", null, "\uD83D", "\uDE00\uD83D", "a\uD83Da" })
            {
                ClientUnit.Holds(!ObjectValidation.IsName(wrong));
            }
        }

        public void WhatTheServerWouldRefuseIsFound()
        {
            Volume ball = new Volume { RadiationPressure = 5.0, Shape = new Sphere { Radius = 0.03 } };
            foreach (IEnvelope good in new IEnvelope[]
            {
                new Pulse { Width = 0.1, Period = 0.1, Rise = 0.05, Low = 0.3, High = 0.3 },
                new Noise { LowFrequency = 99.0, HighFrequency = 100.0 },
            })
            {
                ball.Envelope = good;
                ClientUnit.Equal("", ObjectValidation.Problem(ball));
            }
            Refused(ball, new Sine { Frequency = 150.0, Low = 0.9, High = 0.1 }, "at least `low` (envelope.high)");
            Refused(ball, new Square { Frequency = 150.0, Low = 0.9, High = 0.1 }, "at least `low` (envelope.high)");
            Refused(
                ball, new Noise { LowFrequency = 200.0, HighFrequency = 100.0 }, "below `high_frequency` (envelope.low_frequency)");
            Refused(ball, new Pulse { Width = 0.5, Period = 0.1 }, "at least the width (envelope.period)");
            Refused(ball, new Pulse { Width = 0.5, Rise = 0.4 }, "half of the width (envelope.rise)");
            ball.Envelope = new Constant();
            ball.Pose.Rotation = new Quat(0.0, 0.0, 0.6, 0.804);
            ClientUnit.Equal("", ObjectValidation.Problem(ball)); // the server normalises it
            ball.Pose.Rotation = new Quat();
            Refused(ball, new Constant(), "length 1 (pose.rotation)");
            Point runs = new Point { RadiationPressure = 5.0, Technique = new STM { Frequency = 100.0, Dwell = 0.005 } };
            ClientUnit.Equal("", ObjectValidation.Problem(runs));
            ((STM)runs.Technique).Dwell = 0.02;
            Refused(runs, new Constant(), "to the period (technique.dwell)");
        }

        private static void Refused(HapticObject item, IEnvelope envelope, string says)
        {
            item.Envelope = envelope;
            string problem = ObjectValidation.Problem(item);
            if (!problem.EndsWith(says, StringComparison.Ordinal))
            {
                throw new Exception("wanted " + says + ", found " + problem);
            }
        }

        public void WithoutASessionNothingIsAskedAndNothingThrows()
        {
            using (HapticClient client = new HapticClient(Nobody))
            {
                ClientUnit.Holds(!client.Field(new Bulk(), null));
                ClientUnit.Holds(!client.Hands(new HandFrame[0], double.NaN));
                ClientUnit.Holds(!client.Move("a", new Movement(new Vec3(double.NaN, 0.0, 0.0), Quat.Identity)));
            }
        }
    }
}
