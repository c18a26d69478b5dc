namespace Pacinian
{
    /// <summary>What the game's thread and the worker share.</summary>
    internal sealed class Shared
    {
        public readonly Options Options;
        public readonly Parts Parts = new Parts();
        public readonly Requests Requests = new Requests();
        public readonly News News = new News();
        public readonly Outbox Outbox;
        public readonly Beat Beat = new Beat();

        public Shared(Options options)
        {
            Options = options;
            Outbox = new Outbox(Parts, options.Life);
        }

        /// <summary>A session begins: what is asked from now on is for it.</summary>
        public void Begin(Standing standing)
        {
            Outbox.Open(standing.Session);
            Requests.Open(standing.Session, News);
            News.Stand(standing);
            News.Tell(new Notice { What = Happening.Connected });
        }

        /// <summary>There is no session. begun: there was one, of which nothing is left.</summary>
        public void End(string problem, bool refused, bool begun)
        {
            Outbox.Open(0);
            Requests.Open(0, News);
            Standing standing = Standing.None(refused ? ClientStatus.Refused : ClientStatus.Connecting, problem);
            News.Stand(standing);
            if (begun)
            {
                News.Tell(new Notice { What = Happening.Lost, Why = new Refusal { Message = problem } });
            }
        }
    }
}
