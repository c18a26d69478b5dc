using System;
using System.Collections.Generic;
using Pacinian.Wire;

namespace Pacinian
{
    /// <summary>The waiting commands about objects, by name. Not thread-safe: the outbox's lock protects it.</summary>
    internal sealed class CommandsByObject
    {
        private const int MaxMessageObjectBytes = 900000; // [bytes] of the objects in one message
        private const double MaxTimeDifference = 0.001; // [s] between parts that are sent in one message, with one time

        private static readonly Kind[] Kinds = { Kind.Remove, Kind.Put, Kind.Envelope, Kind.Move };

        private readonly Dictionary<string, ObjectCommands> _waiting = new Dictionary<string, ObjectCommands>();
        private readonly Stack<ObjectCommands> _spare = new Stack<ObjectCommands>();
        private readonly List<string> _done = new List<string>();
        private readonly WriterPool _writers;
        private readonly double _life;

        /// <summary>writers: the pool of the parts. life: the time to live of a command [s].</summary>
        public CommandsByObject(WriterPool writers, double life)
        {
            _writers = writers;
            _life = life;
        }

        /// <summary>
        /// Adds a command about an object, and drops waiting ones that it replaces. part: its bytes, whose ownership
        /// passes.
        /// </summary>
        public void Write(Kind kind, string name, Writer part, ref Movement movement, double now)
        {
            ObjectCommands commands;
            if (!_waiting.TryGetValue(name, out commands))
            {
                commands = _spare.Count > 0 ? _spare.Pop() : new ObjectCommands();
                _waiting.Add(name, commands);
            }
            bool all = kind == Kind.Put || kind == Kind.Remove;
            foreach (Kind old in Kinds)
            {
                if (all || old == kind)
                {
                    _writers.Return(commands.Part(old));
                    commands.Drop(old);
                }
            }
            commands.Keep(kind, part, ref movement, now);
        }

        /// <summary>Moves the next commands to the batch if it is empty. Drops commands whose time to live is over.</summary>
        public void Take(CommandBatch batch, double now)
        {
            for (int i = 0; i < Kinds.Length && batch.Kind == Kind.None && _waiting.Count > 0; i++)
            {
                Take(batch, Kinds[i], now);
                Tidy();
            }
        }

        /// <summary>Drops all commands.</summary>
        public void Forget()
        {
            foreach (KeyValuePair<string, ObjectCommands> pair in _waiting)
            {
                foreach (Kind kind in Kinds)
                {
                    _writers.Return(pair.Value.Part(kind));
                    pair.Value.Drop(kind);
                }
                _done.Add(pair.Key);
            }
            Tidy();
        }

        private void Take(CommandBatch batch, Kind kind, double now)
        {
            int size = 0;
            foreach (KeyValuePair<string, ObjectCommands> pair in _waiting)
            {
                ObjectCommands commands = pair.Value;
                if (!commands.Has(kind))
                {
                    continue;
                }
                Writer part = commands.Part(kind);
                double time = commands.Time(kind);
                if (now - time > _life)
                {
                    _writers.Return(part);
                }
                else if (Fits(batch, kind, time, size + (part == null ? 0 : part.Count)))
                {
                    size += part == null ? 0 : part.Count;
                    batch.Begin(kind, batch.Kind == Kind.None ? time : Math.Min(time, batch.Time));
                    batch.Add(pair.Key, part, commands.Movement);
                }
                else
                {
                    continue;
                }
                commands.Drop(kind);
                if (commands.Empty)
                {
                    _done.Add(pair.Key);
                }
            }
        }

        private static bool Fits(CommandBatch batch, Kind kind, double time, int size)
        {
            return batch.Kind == Kind.None || (kind != Kind.Envelope && size <= MaxMessageObjectBytes
                && Math.Abs(time - batch.Time) <= MaxTimeDifference && batch.Names.Count < Protocol.MaxObjects);
        }

        private void Tidy()
        {
            foreach (string name in _done)
            {
                _spare.Push(_waiting[name]);
                _waiting.Remove(name);
            }
            _done.Clear();
        }
    }
}
