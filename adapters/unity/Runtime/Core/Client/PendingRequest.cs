using System;
using Pacinian.Wire;

namespace Pacinian
{
    /// <summary>A request or command that the server answers.</summary>
    internal sealed class PendingRequest
    {
        private readonly Request _request;
        private readonly Command _command;

        /// <summary>Creates a request for the control socket. what: its name on the wire. timeout: for the answer [s].</summary>
        public PendingRequest(string what, Request request, double timeout)
        {
            What = what;
            _request = request;
            Timeout = timeout;
        }

        /// <summary>Creates a command for the command socket. callback: receives the answer, or null.</summary>
        public PendingRequest(string what, Command command, double timeout, Action<Pressures> callback)
        {
            What = what;
            _command = command;
            Timeout = timeout;
            Callback = callback;
        }

        public string What { get; private set; }

        public double Timeout { get; private set; }

        /// <summary>The time by which the answer must arrive [s].</summary>
        public double Until { get; private set; }

        public Action<Pressures> Callback { get; private set; }

        public Channel Channel
        {
            get { return _command != null ? Channel.Command : Channel.Control; }
        }

        /// <summary>Whether it arms the output.</summary>
        public bool Arms
        {
            get { return _request is Arm; }
        }

        /// <summary>Whether it releases the output.</summary>
        public bool LetsGo
        {
            get { return _request is Disarm; }
        }

        /// <summary>Whether it resets an emergency stop.</summary>
        public bool Resets
        {
            get { return _request is Reset; }
        }

        /// <summary>Writes the message. Replaces the writer's content. sequence: the counter of commands.</summary>
        public void Write(Writer writer, Bulk session, long id, ref long sequence, double now)
        {
            Until = now + Timeout;
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
