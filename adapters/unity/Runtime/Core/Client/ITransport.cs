using System;

namespace Pacinian
{
    /// <summary>The server's three sockets: requests and replies, commands, and the published state.</summary>
    public enum Channel
    {
        Control,
        Command,
        State,
    }

    /// <summary>How a connection has ended.</summary>
    public enum Ending
    {
        /// <summary>The connection has not ended.</summary>
        None,

        /// <summary>No program listens at the address.</summary>
        Nobody,

        /// <summary>The server closed the connection, or is gone.</summary>
        Gone,

        /// <summary>The server rejected the token or key.</summary>
        Denied,

        /// <summary>The peer is not a Pacinian server, or uses another security mechanism.</summary>
        Foreign,
    }

    /// <summary>
    /// Carries whole messages to and from one server. All members except <see cref="Wake"/> belong to one thread, and
    /// only <see cref="Wait"/> blocks. A connection that has ended does not come back, and it accepts messages only
    /// while it is connected. Therefore no old message reaches a restarted server.
    /// </summary>
    public interface ITransport : IDisposable
    {
        /// <summary>Starts to connect, only to the control socket unless `all`. Returns "", or the reason for a failure.</summary>
        string Open(ConnectionFile file, bool all);

        /// <summary>Returns how the connection has ended.</summary>
        Ending Ended();

        /// <summary>Why the connection has ended, for people; "" if unknown, or if it has not ended.</summary>
        string Problem { get; }

        /// <summary>Returns whether a message can be sent now. If not, the next wait ends when there is room.</summary>
        bool Room(Channel channel);

        /// <summary>Sends the first bytes of data. Returns false if there is no room, as above.</summary>
        bool Send(Channel channel, byte[] data, int count);

        /// <summary>Receives the next message, without its topic. Returns its length; -1 if there is none.</summary>
        int Receive(Channel channel, byte[] into);

        /// <summary>Waits for a message, for Wake, or for this time [s] at most.</summary>
        void Wait(double seconds);

        /// <summary>Ends the present wait, or the next one. May be called from any thread, even after Dispose.</summary>
        void Wake();

        /// <summary>Closes the connection at once. Messages that were not sent are dropped.</summary>
        void Close();
    }
}
