using System;

namespace Pacinian
{
    /// <summary>The server's three sockets: requests and their answers, commands, the published state.</summary>
    public enum Channel
    {
        Control,
        Command,
        State,
    }

    /// <summary>How a connection has ended.</summary>
    public enum Ending
    {
        /// <summary>It has not.</summary>
        None,

        /// <summary>Nobody listens there.</summary>
        Nobody,

        /// <summary>It was there, and has gone.</summary>
        Gone,

        /// <summary>It refuses the token or key.</summary>
        Denied,

        /// <summary>It is no Pacinian server, or wants other security.</summary>
        Foreign,
    }

    /// <summary>
    /// Carries whole messages to and from one server. All but <see cref="Wake"/> belongs to one thread, and nothing
    /// but <see cref="Wait"/> waits. Once a connection has ended it does not come back by itself, and it takes a
    /// message only while it stands: so nothing old can reach a server that was started anew.
    /// </summary>
    public interface ITransport : IDisposable
    {
        /// <summary>Begins to connect, to the control socket alone unless all; "" or why it cannot.</summary>
        string Open(ConnectionFile file, bool all);

        /// <summary>How the connection has ended.</summary>
        Ending Ended();

        /// <summary>Why the connection has ended, for people; "" if that is not known, or it has not.</summary>
        string Problem { get; }

        /// <summary>Whether a message can be sent now; if not, the next wait ends when it can.</summary>
        bool Room(Channel channel);

        /// <summary>Sends the first bytes of data; false if there is no room, as above.</summary>
        bool Send(Channel channel, byte[] data, int count);

        /// <summary>The next message, without its topic: how many bytes it is; -1 if there is none.</summary>
        int Receive(Channel channel, byte[] into);

        /// <summary>Waits until something has come, it is woken, or so long [s].</summary>
        void Wait(double seconds);

        /// <summary>Ends a wait, now or the next; from any thread, also after the end.</summary>
        void Wake();

        /// <summary>Ends the connection at once; what was not sent is not sent any more.</summary>
        void Close();
    }
}
