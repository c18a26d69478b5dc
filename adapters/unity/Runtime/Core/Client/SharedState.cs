namespace Pacinian
{
    /// <summary>The state that the game's thread and the worker share.</summary>
    internal sealed class SharedState
    {
        public readonly Options Options;
        public readonly WriterPool Writers = new WriterPool();
        public readonly UnsentRequests Requests = new UnsentRequests();
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
        public void StartSession(SessionState sessionState)
        {
            Outbox.Open(sessionState.Session);
            Requests.Open(sessionState.Session, Inbox);
            Inbox.SetSessionState(sessionState);
            Inbox.AddEvent(new ClientEvent { What = ClientEventKind.Connected });
        }

        /// <summary>Ends the session. begun: whether there was one, so that its loss is reported.</summary>
        public void EndSession(string problem, bool refused, bool begun)
        {
            Outbox.Open(0);
            Requests.Open(0, Inbox);
            SessionState sessionState = SessionState.None(refused ? ClientStatus.Refused : ClientStatus.Connecting, problem);
            Inbox.SetSessionState(sessionState);
            if (begun)
            {
                Inbox.AddLoss(problem);
            }
        }
    }
}
