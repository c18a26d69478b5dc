using System.Collections.Generic;
using Pacinian.Wire;

namespace Pacinian
{
    /// <summary>The kinds of commands, in the order in which they are sent.</summary>
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

    /// <summary>The content of one command. The object is reused for the next command.</summary>
    internal sealed class CommandBatch
    {
        public readonly List<string> Names = new List<string>(Protocol.MaxObjects);
        public readonly List<Writer> Parts = new List<Writer>(Protocol.MaxObjects);
        public readonly List<Movement> Movements = new List<Movement>(Protocol.MaxObjects);

        public Kind Kind { get; private set; }

        /// <summary>The time at which the oldest part was written [s].</summary>
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

        /// <summary>Returns the parts to the pool after the command was sent.</summary>
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
