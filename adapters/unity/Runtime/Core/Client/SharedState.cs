namespace Pacinian
{
    /// <summary>What the game's thread and the worker share.</summary>
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

        /// <summary>A session begins: what is asked from now on is for it.</summary>
        public void Begin(Standing standing)
        {
            Outbox.Open(standing.Session);
            Requests.Open(standing.Session, Inbox);
            Inbox.Stand(standing);
            Inbox.Tell(new Notice { What = Happening.Connected });
        }

        /// <summary>There is no session. begun: there was one, of which nothing is left.</summary>
        public void End(string problem, bool refused, bool begun)
        {
            Outbox.Open(0);
            Requests.Open(0, Inbox);
            Standing standing = Standing.None(refused ? ClientStatus.Refused : ClientStatus.Connecting, problem);
            Inbox.Stand(standing);
            if (begun)
            {
                Inbox.Tell(new Notice { What = Happening.Lost, Why = new Refusal { Message = problem } });
            }
        }
    }
}
