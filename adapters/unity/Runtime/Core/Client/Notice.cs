using System;
using Pacinian.Wire;

namespace Pacinian
{
    /// <summary>The kinds of notices.</summary>
    internal enum Happening
    {
        None,
        Connected,
        Lost,
        Ended,
        Refused,
        Answered,
    }

    /// <summary>Something that an event reports on the game's thread.</summary>
    internal struct Notice
    {
        public Happening What;
        public Refusal Why;
        public Action<Pressures> Callback;
        public Pressures Answer;
    }
}
