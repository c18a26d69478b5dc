using System;
using System.Collections.Generic;
using Pacinian.Wire;

namespace Pacinian.Tests
{
    /// <summary>Tests of the outbox: replaced commands and the time to live.</summary>
    internal sealed class ClientUnitOutbox
    {
        private const double Life = 1.0; // [s]

        private readonly WriterPool _writers = new WriterPool();
        private readonly CommandBatch _batch = new CommandBatch();
        private readonly Outbox _outbox;

        public ClientUnitOutbox()
        {
            _outbox = new Outbox(_writers, Life);
            _outbox.Open(1);
        }

        public void NothingWaits()
        {
            ClientUnit.Holds(!_outbox.Take(_batch, 0.0));
        }

        public void OfOtherSessionsNothingIsKept()
        {
            ClientUnit.Holds(!Write(0, Kind.Move, "a", 0.0));
            ClientUnit.Holds(!Write(2, Kind.Move, "a", 0.0));
            ClientUnit.Holds(Write(1, Kind.Put, "a", 0.0));
            ClientUnit.Holds(_outbox.Write(1, Kind.Hands, Part(), 0.0));
            _outbox.Open(2);
            ClientUnit.Equal("", Taken(0.0));
            _outbox.Open(0);
            ClientUnit.Holds(!Write(0, Kind.Put, "a", 0.0));
            ClientUnit.Holds(!_outbox.Clear(1, 0.0));
        }

        public void TheNewestOfEachKindAndObject()
        {
            for (int i = 0; i < 5; i++)
            {
                Write(1, Kind.Put, "a", 0.0);
                Write(1, Kind.Move, "a", 0.0);
                Write(1, Kind.Move, "b", 0.0);
                Write(1, Kind.Envelope, "a", 0.0);
                _outbox.Write(1, Kind.Hands, Part(), 0.0);
                _outbox.Write(1, Kind.Quiet, Part(), 0.0);
            }
            ClientUnit.Equal("Quiet() Put(a) Envelope(a) Move(a,b) Hands()", Taken(0.0));
            ClientUnit.Equal("", Taken(0.0));
        }

        public void WhatIsPutOrRemovedOutdoesAllBefore()
        {
            foreach (Kind kind in new[] { Kind.Put, Kind.Remove })
            {
                foreach (Kind before in new[] { Kind.Put, Kind.Remove, Kind.Envelope, Kind.Move })
                {
                    Write(1, before, "a", 0.0);
                }
                Write(1, kind, "a", 0.0);
                ClientUnit.Equal(kind + "(a)", Taken(0.0));
                Write(1, kind, "a", 0.0);
                Write(1, Kind.Move, "a", 0.0);
                ClientUnit.Equal(kind + "(a) Move(a)", Taken(0.0));
            }
        }

        public void ClearOutdoesEverything()
        {
            Write(1, Kind.Put, "a", 0.0);
            _outbox.Write(1, Kind.Hands, Part(), 0.0);
            _outbox.Write(1, Kind.Quiet, Part(), 0.0);
            ClientUnit.Holds(_outbox.Clear(1, 0.0));
            Write(1, Kind.Put, "b", 0.0);
            ClientUnit.Equal("Clear() Put(b)", Taken(0.0));
        }

        public void WhatHasLivedTooLongIsDropped()
        {
            Write(1, Kind.Put, "a", 0.0);
            Write(1, Kind.Move, "b", 0.5);
            _outbox.Write(1, Kind.Hands, Part(), 0.0);
            ClientUnit.Equal("Move(b)", Taken(1.2));
            _outbox.Clear(1, 2.0);
            ClientUnit.Equal("", Taken(3.1));
        }

        public void OneCommandHoldsWhatHasOneTime()
        {
            Write(1, Kind.Move, "a", 0.0);
            Write(1, Kind.Move, "b", 0.0005);
            Write(1, Kind.Move, "c", 0.5);
            ClientUnit.Equal("Move(a,b) Move(c)", Taken(0.5));
        }

        public void OneCommandHoldsNoMoreThanItMay()
        {
            for (int i = 0; i < 600; i++)
            {
                Write(1, Kind.Move, "o" + i, 0.0);
            }
            int seen = 0;
            while (_outbox.Take(_batch, 0.0))
            {
                seen += _batch.Names.Count;
                ClientUnit.Holds(_batch.Names.Count <= Protocol.MaxObjects);
            }
            ClientUnit.Equal(600, seen);
            for (int i = 0; i < 5; i++)
            {
                Writer part = Part();
                part.Raw(new byte[400000], 0, 400000);
                Movement none = new Movement();
                _outbox.Write(1, Kind.Put, "o" + i, part, ref none, 0.0);
            }
            ClientUnit.Equal(3, Taken(0.0).Split(' ').Length);
        }

        public void NothingIsAllocatedWhenItRuns()
        {
            Commands commands = new Commands(Life);
            Writer writer = new Writer();
            Bulk session = new Bulk();
            session.Set(new byte[Protocol.SessionBytes], 0, Protocol.SessionBytes);
            string[] names = { "a", "b", "c" };
            Movement movement = new Movement();
            long begin = 0;
            for (int i = 0; i < 1000; i++)
            {
                begin = i == 100 ? GC.GetAllocatedBytesForCurrentThread() : begin;
                foreach (string name in names)
                {
                    _outbox.Write(1, Kind.Put, name, Part(), ref movement, 0.0);
                    _outbox.Write(1, Kind.Move, name, null, ref movement, 0.0);
                }
                _outbox.Write(1, Kind.Hands, Part(), 0.0);
                while (_outbox.Take(_batch, 0.0))
                {
                    commands.Write(writer, _batch, session, i + 1);
                    _batch.Return(_writers);
                }
            }
            ClientUnit.Equal(0L, GC.GetAllocatedBytesForCurrentThread() - begin);
        }

        private bool Write(int session, Kind kind, string name, double now)
        {
            Movement movement = new Movement();
            Writer part = kind == Kind.Put || kind == Kind.Envelope ? Part() : null;
            return _outbox.Write(session, kind, name, part, ref movement, now);
        }

        private Writer Part()
        {
            return _writers.Rent();
        }

        private string Taken(double now)
        {
            List<string> all = new List<string>();
            while (_outbox.Take(_batch, now))
            {
                _batch.Names.Sort();
                all.Add(_batch.Kind + "(" + string.Join(",", _batch.Names.ToArray()) + ")");
            }
            return string.Join(" ", all.ToArray());
        }
    }
}
