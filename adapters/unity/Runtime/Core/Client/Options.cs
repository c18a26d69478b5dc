using System;

namespace Pacinian
{
    /// <summary>How a client connects.</summary>
    public sealed class Options
    {
        /// <summary>
        /// The connection file; where PACINIAN_CONNECTION says, or where the server writes it, unless given. Or the file's content,
        /// which begins with {: for a server whose files this program cannot read, as from a headset.
        /// </summary>
        public string ConnectionPath = "";

        /// <summary>Who this is, for people: 1 to 64 characters.</summary>
        public string Name = "game";

        /// <summary>The game's version, for people.</summary>
        public string Version = "";

        /// <summary>Clients of one name share a scene; one of its own unless given.</summary>
        public string Scene = "";

        /// <summary>Within which the game must tick while it is armed [s]; 0: the server's, which is the most.</summary>
        public double Lease;

        /// <summary>A command that the server would apply later than so long after it was asked for is dropped [s].</summary>
        public double Life = 1.0;

        /// <summary>An answer that takes longer means that the server hangs [s].</summary>
        public double Timeout = 2.0;

        /// <summary>A steady clock [s].</summary>
        public Func<double> Clock = Timing.Now;

        /// <summary>Makes the transport, on the thread that it belongs to.</summary>
        public Func<ITransport> Transport = Transports.Make;
    }
}
