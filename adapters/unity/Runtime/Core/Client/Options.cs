using System;

namespace Pacinian
{
    /// <summary>Options of a client.</summary>
    public sealed class Options
    {
        /// <summary>
        /// The path of the connection file; "": the path in PACINIAN_CONNECTION, or the place where the server writes
        /// it. Or the content of the file, which begins with {, if the client cannot read the server's files, as on a
        /// headset.
        /// </summary>
        public string ConnectionPath = "";

        /// <summary>The name of the client, shown to people: 1 to 64 characters.</summary>
        public string Name = "game";

        /// <summary>The version of the game, shown to people: 200 characters at most.</summary>
        public string Version = "";

        /// <summary>Clients with the same name share a scene; "": a scene of its own. 64 characters at most.</summary>
        public string Scene = "";

        /// <summary>
        /// The longest time between two ticks while the client is armed [s], 0.05 to 10; 0: the longest that the server
        /// allows, which is also the upper limit.
        /// </summary>
        public double Lease;

        /// <summary>
        /// The time to live of a command [s], more than 0 and at most 60: the server drops it if it would apply it later.
        /// </summary>
        public double Life = 1.0;

        /// <summary>If an answer takes longer, the client takes the server to be hanging [s]; more than 0.</summary>
        public double Timeout = 2.0;

        /// <summary>A monotonic clock [s].</summary>
        public Func<double> Clock = SteadyClock.Now;

        /// <summary>Creates the transport, on the thread that uses it.</summary>
        public Func<ITransport> Transport = Transports.Make;
    }
}
