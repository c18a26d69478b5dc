using System;
using System.Collections.Generic;
using System.Threading;
using Pacinian.Wire;

namespace Pacinian
{
    /// <summary>The scene. A command that waits to be sent is dropped if a newer command replaces it.</summary>
    public sealed partial class HapticClient
    {
        private const int Largest = Protocol.MaxCommandBytes - 1024; // [bytes] of an envelope; the rest is for other fields

        private readonly Reader _checker = new Reader();

        /// <summary>
        /// Adds an object, or replaces the one with this name. The object is encoded now, and may be changed
        /// afterwards. If a field is wrong by the wire's rules, or the radiation pressure higher than the server allows,
        /// returns false, and <see cref="Refused"/> is raised at the next tick with the object's name. What only the server
        /// can check, such as whether a mesh is closed, it refuses later; then <see cref="Refused"/> is raised, too.
        /// </summary>
        public bool Put(string name, HapticObject item)
        {
            if (!IsGamesThread("Put"))
            {
                return false;
            }
            Writer part = _shared.Writers.Rent();
            item.Write(part);
            Refusal why;
            if (ObjectValidation.Find(name, item, part, _checker, MaxPressure, out why))
            {
                _shared.Inbox.AddRefusal(why);
                _shared.Writers.Return(part);
                return false;
            }
            return ReportNoSession("put", Write(Kind.Put, name, part, new Movement()));
        }

        /// <summary>
        /// Moves an existing object. Clamps to 10 m along each axis and to 100 m/s; returns false for numbers that are not
        /// finite.
        /// </summary>
        public bool Move(string name, Movement movement)
        {
            if (!IsGamesThread("Move") || !ObjectValidation.IsName(name) || !IsFinite(movement))
            {
                return false;
            }
            Vec3 place = movement.Position;
            movement.Position = new Vec3(Clamp(place.X), Clamp(place.Y), Clamp(place.Z));
            movement.Velocity = Shorten(movement.Velocity);
            movement.AngularVelocity = Shorten(movement.AngularVelocity);
            return Write(Kind.Move, name, null, movement);
        }

        /// <summary>Removes an object. Does nothing if there is none with this name.</summary>
        public bool Remove(string name)
        {
            return IsGamesThread("Remove") && ObjectValidation.IsName(name) && Write(Kind.Remove, name, null, new Movement());
        }

        /// <summary>Removes all objects, hands and quiet zones of this client.</summary>
        public bool Clear()
        {
            return IsGamesThread("Clear") && ReportNoSession("clear", WakeWorker(_shared.Outbox.Clear(_sessionState.Session, Now)));
        }

        /// <summary>Replaces the envelope of an existing object.</summary>
        public bool Envelope(string name, IEnvelope envelope)
        {
            if (!IsGamesThread("Envelope") || !ObjectValidation.IsName(name))
            {
                return false;
            }
            Writer part = _shared.Writers.Rent();
            envelope.Write(part);
            return Fits(part, "$.envelope") && ReportNoSession("envelope", Write(Kind.Envelope, name, part, new Movement()));
        }

        /// <summary>
        /// Replaces all tracked hands. From then on, objects are felt only where hands touch them. If there are no
        /// hands, or only lost ones (without joints), nothing is felt.
        /// </summary>
        public bool Hands(IList<HandFrame> hands)
        {
            return Hands(hands, Now);
        }

        /// <summary>Does the same for hands at a given time of the client's clock [s]; now at the latest.</summary>
        public bool Hands(IList<HandFrame> hands, double time)
        {
            if (!IsGamesThread("Hands"))
            {
                return false;
            }
            double now = Now;
            time = time < now ? time : now; // also for a time that is not a number
            Writer part = _shared.Writers.Rent();
            part.Array(hands.Count);
            for (int i = 0; i < hands.Count; i++)
            {
                hands[i].Write(part);
            }
            return WakeWorker(_shared.Outbox.Write(_sessionState.Session, Kind.Hands, part, time));
        }

        /// <summary>Replaces all quiet zones of this client.</summary>
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
            return ReportNoSession("quiet", WakeWorker(_shared.Outbox.Write(_sessionState.Session, Kind.Quiet, part, Now)));
        }

        /// <summary>The highest radiation pressure that the server allows [Pa].</summary>
        private double MaxPressure
        {
            get
            {
                int at = Capabilities == null ? -1 : Capabilities.Limits.Find("pressure");
                return at < 0 ? double.PositiveInfinity : Capabilities.Limits.Value(at);
            }
        }

        private static bool IsFinite(Movement movement)
        {
            double sum = movement.Position.Length + movement.Velocity.Length + movement.AngularVelocity.Length;
            Quat rotation = movement.Rotation;
            sum += Math.Abs(rotation.X) + Math.Abs(rotation.Y) + Math.Abs(rotation.Z) + Math.Abs(rotation.W);
            return sum < double.PositiveInfinity;
        }

        private static double Clamp(double place)
        {
            return Math.Max(-Protocol.MaxCoordinate, Math.Min(place, Protocol.MaxCoordinate));
        }

        private static Vec3 Shorten(Vec3 speed)
        {
            double length = speed.Length;
            return length > Protocol.MaxSpeed
                ? (Protocol.MaxSpeed * (1.0 - 1e-6) / length) * speed : speed; // also in single precision
        }

        private bool Write(Kind kind, string name, Writer part, Movement movement)
        {
            return WakeWorker(_shared.Outbox.Write(_sessionState.Session, kind, name, part, ref movement, Now));
        }

        /// <summary>
        /// Reports the first command without a session as a refusal. Does not report commands that are sent every
        /// frame.
        /// </summary>
        private bool ReportNoSession(string what, bool done)
        {
            if (!done && !_reportedNoSession)
            {
                _reportedNoSession = true;
                _shared.Inbox.AddRefusal(ErrorMessages.NoSession(what, _started));
            }
            return done;
        }

        /// <summary>
        /// Returns whether the call comes from the thread that ticked last; before the first tick, from the one that called
        /// first. Reports the first wrong call.
        /// </summary>
        private bool IsGamesThread(string call)
        {
            int thread = Environment.CurrentManagedThreadId;
            int game = Interlocked.CompareExchange(ref _thread, thread, 0);
            if (game == 0 || game == thread)
            {
                return true;
            }
            if (!_reportedThread)
            {
                _reportedThread = true;
                _shared.Inbox.AddRefusal(ErrorMessages.WrongThread(call));
            }
            return false;
        }

        private bool WakeWorker(bool done)
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
            _shared.Inbox.AddRefusal(new Refusal
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
