using System;
using System.Collections.Generic;
using System.Threading;
using Pacinian.Wire;

namespace Pacinian
{
    /// <summary>What is to be felt. Of what waits to be sent about one object only the newest is sent.</summary>
    public sealed partial class HapticClient
    {
        private const int Largest = Protocol.MaxCommandBytes - 1024; // [bytes] of an envelope: the rest is for other fields

        private readonly Reader _checker = new Reader();

        /// <summary>
        /// An object: new, or in place of the one of that name. It is read now, and can be changed after. What the server would
        /// refuse is refused here, by name: false, and <see cref="Refused"/> is raised at the next tick.
        /// </summary>
        public bool Put(string name, Felt item)
        {
            if (!IsGamesThread("Put"))
            {
                return false;
            }
            Writer part = _shared.Writers.Rent();
            item.Write(part);
            Refusal why;
            if (ObjectValidation.Find(name, item, part, _checker, out why))
            {
                _shared.Inbox.Refuse(why);
                _shared.Writers.Return(part);
                return false;
            }
            return Told("put", Write(Kind.Put, name, part, new Movement()));
        }

        /// <summary>A new pose of an object that is there.</summary>
        public bool Move(string name, Movement movement)
        {
            return IsGamesThread("Move") && Write(Kind.Move, name, null, movement);
        }

        /// <summary>Takes an object away; a name that nothing has is no error.</summary>
        public bool Remove(string name)
        {
            return IsGamesThread("Remove") && Write(Kind.Remove, name, null, new Movement());
        }

        /// <summary>Takes away all objects, hands and quiet zones of this client.</summary>
        public bool Clear()
        {
            return IsGamesThread("Clear") && Told("clear", Woken(_shared.Outbox.Clear(_standing.Session, Now)));
        }

        /// <summary>How strong an object that is there is over time, from now on.</summary>
        public bool Envelope(string name, IEnvelope envelope)
        {
            if (!IsGamesThread("Envelope"))
            {
                return false;
            }
            Writer part = _shared.Writers.Rent();
            envelope.Write(part);
            return Fits(part, "$.envelope") && Told("envelope", Write(Kind.Envelope, name, part, new Movement()));
        }

        /// <summary>
        /// All hands that are tracked, in place of those before; from then on only hands feel the scene: with none, or
        /// only lost ones, which have no joints, nothing is felt.
        /// </summary>
        public bool Hands(IList<HandFrame> hands)
        {
            return Hands(hands, Now);
        }

        /// <summary>The same, as they were at a time of our clock [s].</summary>
        public bool Hands(IList<HandFrame> hands, double time)
        {
            if (!IsGamesThread("Hands"))
            {
                return false;
            }
            Writer part = _shared.Writers.Rent();
            part.Array(hands.Count);
            for (int i = 0; i < hands.Count; i++)
            {
                hands[i].Write(part);
            }
            return Woken(_shared.Outbox.Write(_standing.Session, Kind.Hands, part, time));
        }

        /// <summary>All quiet zones of this client, in place of those before.</summary>
        public bool Quiet(IList<Zone> zones)
        {
            if (!IsGamesThread("Quiet"))
            {
                return false;
            }
            Writer part = _shared.Writers.Rent();
            part.Array(zones.Count);
            for (int i = 0; i < zones.Count; i++)
            {
                zones[i].Write(part);
            }
            return Told("quiet", Woken(_shared.Outbox.Write(_standing.Session, Kind.Quiet, part, Now)));
        }

        private bool Write(Kind kind, string name, Writer part, Movement movement)
        {
            return Woken(_shared.Outbox.Write(_standing.Session, kind, name, part, ref movement, Now));
        }

        /// <summary>Refuses aloud what was asked for without a session: once, until the next. Not what is sent in each frame.</summary>
        private bool Told(string what, bool done)
        {
            if (!done && !_toldNoSession)
            {
                _toldNoSession = true;
                _shared.Inbox.Refuse(Problems.NoSession(what, _started));
            }
            return done;
        }

        /// <summary>Whether a call comes from the thread that ticked last, or none has; if not, that is told, once.</summary>
        private bool IsGamesThread(string call)
        {
            int thread = Environment.CurrentManagedThreadId;
            if (_thread == 0 || _thread == thread)
            {
                return true;
            }
            if (!_toldThread)
            {
                _toldThread = true;
                _shared.Inbox.Refuse(Problems.WrongThread(call));
            }
            return false;
        }

        private bool Woken(bool done)
        {
            if (done)
            {
                _worker.Wake();
            }
            return done;
        }

        private bool Fits(Writer part, string path)
        {
            if (part.Count <= Largest)
            {
                return true;
            }
            _shared.Inbox.Refuse(new Refusal
            {
                Code = "limit",
                Message = "is " + part.Count + " bytes: keep to " + Largest,
                Path = path,
                Advice = "use fewer points, faces or values",
            });
            _shared.Writers.Return(part);
            return false;
        }
    }
}
