using System;
using Pacinian.Wire;

namespace Pacinian
{
    /// <summary>The kinds of events.</summary>
    internal enum ClientEventKind
    {
        None,
        Connected,
        Lost,
        Ended,
        Refused,
        Answered,
    }

    /// <summary>Something that an event reports on the game's thread.</summary>
    internal struct ClientEvent
    {
        public ClientEventKind What;
        public Refusal Why;
        public Action<Pressures> Callback;
        public Pressures Answer;
    }
}
