namespace Pacinian
{
    /// <summary>The state that the game's thread and the worker share.</summary>
    internal sealed class SharedState
    {
        public readonly Options Options;
        public readonly WriterPool Writers = new WriterPool();
        public readonly RequestQueue Requests = new RequestQueue();
        public readonly Inbox Inbox = new Inbox();
        public readonly Outbox Outbox;
        public readonly Heartbeat Heartbeat = new Heartbeat();
        public readonly PendingStops PendingStops = new PendingStops();

        public SharedState(Options options)
        {
            Options = options;
            Outbox = new Outbox(Writers, options.Life);
        }

        /// <summary>Starts a session: commands and requests from now on belong to it.</summary>
        public void StartSession(Standing standing)
        {
            Outbox.Open(standing.Session);
            Requests.Open(standing.Session, Inbox);
            Inbox.SetStanding(standing);
            Inbox.AddNotice(new Notice { What = Happening.Connected });
        }

        /// <summary>Ends the session. begun: whether there was one, so that its loss is reported.</summary>
        public void EndSession(string problem, bool refused, bool begun)
        {
            Outbox.Open(0);
            Requests.Open(0, Inbox);
            Standing standing = Standing.None(refused ? ClientStatus.Refused : ClientStatus.Connecting, problem);
            Inbox.SetStanding(standing);
            if (begun)
            {
                Inbox.AddNotice(new Notice { What = Happening.Lost, Why = new Refusal { Message = problem } });
            }
        }
    }
}
