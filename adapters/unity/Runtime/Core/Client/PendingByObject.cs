using System;
using System.Collections.Generic;
using Pacinian.Wire;

namespace Pacinian
{
    /// <summary>The waiting commands about objects, by name. Not thread-safe: the outbox's lock protects it.</summary>
    internal sealed class PendingByObject
    {
        private const int Full = 900000; // [bytes] of the objects in one message
        private const double Together = 0.001; // [s] between parts that are sent in one message, with one time

        private static readonly Kind[] Kinds = { Kind.Remove, Kind.Put, Kind.Envelope, Kind.Move };

        private readonly Dictionary<string, PendingOfObject> _waiting = new Dictionary<string, PendingOfObject>();
        private readonly Stack<PendingOfObject> _spare = new Stack<PendingOfObject>();
        private readonly List<string> _done = new List<string>();
        private readonly WriterPool _writers;
        private readonly double _life;

        /// <summary>writers: the pool of the parts. life: the time to live of a command [s].</summary>
        public PendingByObject(WriterPool writers, double life)
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
            PendingOfObject pending;
            if (!_waiting.TryGetValue(name, out pending))
            {
                pending = _spare.Count > 0 ? _spare.Pop() : new PendingOfObject();
                _waiting.Add(name, pending);
            }
            bool all = kind == Kind.Put || kind == Kind.Remove;
            foreach (Kind old in Kinds)
            {
                if (all || old == kind)
                {
                    _writers.Return(pending.Part(old));
                    pending.Drop(old);
                }
            }
            pending.Keep(kind, part, ref movement, now);
        }

        /// <summary>Moves the next commands to the batch if it is empty. Drops commands whose time to live is over.</summary>
        public void Take(Batch batch, double now)
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
            foreach (KeyValuePair<string, PendingOfObject> pair in _waiting)
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

        private void Take(Batch batch, Kind kind, double now)
        {
            int size = 0;
            foreach (KeyValuePair<string, PendingOfObject> pair in _waiting)
            {
                PendingOfObject pending = pair.Value;
                if (!pending.Has(kind))
                {
                    continue;
                }
                Writer part = pending.Part(kind);
                double time = pending.Time(kind);
                if (now - time > _life)
                {
                    _writers.Return(part);
                }
                else if (Fits(batch, kind, time, size + (part == null ? 0 : part.Count)))
                {
                    size += part == null ? 0 : part.Count;
                    batch.Begin(kind, batch.Kind == Kind.None ? time : Math.Min(time, batch.Time));
                    batch.Add(pair.Key, part, pending.Movement);
                }
                else
                {
                    continue;
                }
                pending.Drop(kind);
                if (pending.Empty)
                {
                    _done.Add(pair.Key);
                }
            }
        }

        private static bool Fits(Batch batch, Kind kind, double time, int size)
        {
            return batch.Kind == Kind.None || (kind != Kind.Envelope && size <= Full
                && Math.Abs(time - batch.Time) <= Together && batch.Names.Count < Protocol.MaxObjects);
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
