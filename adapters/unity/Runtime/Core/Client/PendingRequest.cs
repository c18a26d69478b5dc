using System;
using Pacinian.Wire;

namespace Pacinian
{
    /// <summary>Something that is asked of the server, and answered.</summary>
    internal sealed class PendingRequest
    {
        private readonly Request _request;
        private readonly Command _command;

        /// <summary>To the control socket. what: as it is called on the wire. patience: for the answer [s].</summary>
        public PendingRequest(string what, Request request, double patience)
        {
            What = what;
            _request = request;
            Patience = patience;
        }

        /// <summary>To the command socket. callback: is given the answer, or null.</summary>
        public PendingRequest(string what, Command command, double patience, Action<Pressures> callback)
        {
            What = what;
            _command = command;
            Patience = patience;
            Callback = callback;
        }

        public string What { get; private set; }

        public double Patience { get; private set; }

        /// <summary>By when there must be an answer [s].</summary>
        public double Until { get; private set; }

        public Action<Pressures> Callback { get; private set; }

        public Channel Channel
        {
            get { return _command != null ? Channel.Command : Channel.Control; }
        }

        /// <summary>Whether this client is armed after it is done.</summary>
        public bool Arms
        {
            get { return _request is Arm; }
        }

        /// <summary>Whether it lets the output go.</summary>
        public bool LetsGo
        {
            get { return _request is Disarm; }
        }

        /// <summary>Whether it ends a stop.</summary>
        public bool Resets
        {
            get { return _request is Reset; }
        }

        /// <summary>Writes it, in place of what the writer holds. sequence: for commands.</summary>
        public void Write(Writer writer, Bulk session, long id, ref long sequence, double now)
        {
            Until = now + Patience;
            writer.Clear();
            if (_command == null)
            {
                _request.Session = session;
                _request.Id = id;
                _request.Write(writer);
                return;
            }
            _command.Session = session;
            _command.Id = id;
            _command.Sequence = ++sequence;
            _command.Time = now;
            _command.Write(writer);
        }
    }
}
