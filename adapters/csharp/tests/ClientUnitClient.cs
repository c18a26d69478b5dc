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
