using System.Collections.Generic;
using Pacinian.Wire;

namespace Pacinian
{
    /// <summary>Kinds of commands, in the order in which they are sent.</summary>
    internal enum Kind
    {
        None,
        Clear,
        Quiet,
        Remove,
        Put,
        Envelope,
        Move,
        Hands,
    }

    /// <summary>What is sent in one command. Used again for the next.</summary>
    internal sealed class Batch
    {
        public readonly List<string> Names = new List<string>(Protocol.MaxObjects);
        public readonly List<Writer> Parts = new List<Writer>(Protocol.MaxObjects);
        public readonly List<Movement> Movements = new List<Movement>(Protocol.MaxObjects);

        public Kind Kind { get; private set; }

        /// <summary>When the oldest of it was asked for [s].</summary>
        public double Time { get; private set; }

        public void Begin(Kind kind, double time)
        {
            Kind = kind;
            Time = time;
        }

        public void Add(string name, Writer part, Movement movement)
        {
            Names.Add(name);
            Movements.Add(movement);
            if (part != null)
            {
                Parts.Add(part);
            }
        }

        /// <summary>It was sent: its parts are used again.</summary>
        public void Return(WriterPool writers)
        {
            foreach (Writer part in Parts)
            {
                writers.Return(part);
            }
            Clear();
        }

        public void Clear()
        {
            Begin(Kind.None, 0.0);
            Names.Clear();
            Parts.Clear();
            Movements.Clear();
        }
    }
}
