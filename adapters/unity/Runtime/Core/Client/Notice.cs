using System;
using Pacinian.Wire;

namespace Pacinian
{
    /// <summary>What is told by an event.</summary>
    internal enum Happening
    {
        None,
        Connected,
        Lost,
        Ended,
        Refused,
        Answered,
    }

    /// <summary>Something that has happened, to be told on the game's thread.</summary>
    internal struct Notice
    {
        public Happening What;
        public Refusal Why;
        public Action<Pressures> Callback;
        public Pressures Answer;
    }
}
