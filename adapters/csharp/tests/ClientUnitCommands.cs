using System;
using Pacinian.Wire;

namespace Pacinian.Tests
{
    /// <summary>Commands must have the same bytes as the wire's messages.</summary>
    internal sealed class ClientUnitCommands
    {
        private const double Life = 1.0; // [s]

        private readonly Outbox _outbox = new Outbox(new WriterPool(), Life);
        private readonly CommandBatch _batch = new CommandBatch();

        public ClientUnitCommands()
        {
            _outbox.Open(1);
        }

        public void ABatchIsWrittenAsTheMessageIs()
        {
            Bulk session = new Bulk();
            session.Set(new byte[Protocol.SessionBytes], 0, Protocol.SessionBytes);
            Envelopes envelopes = new Envelopes { Envelope = new Sine { Frequency = 100.0 } };
            envelopes.Names.Add("a");
            Hands hands = new Hands();
            hands.All.Add(new HandFrame());
            Quiet quiet = new Quiet();
            quiet.Zones.Add(new Zone { Position = new Vec3(0.1, 0.2, 0.3), Pressure = 50.0 });
            Remove remove = new Remove();
            remove.Names.Add("a");
            Put put = new Put();
            put.Objects.Set("a", new Point { Position = new Vec3(0.0, 0.0, 0.2), RadiationPressure = 5.0 });
            Move move = new Move();
            move.Names.Add("a");
            Movement movement = new Movement(new Vec3(0.1, 0.2, 0.3), Quat.Identity);
            move.Poses.Add(movement.Position);
            move.Poses.Add(movement.Rotation);
            Same(new Clear(), session, () => _outbox.Clear(1, 0.25));
            Same(envelopes, session, () => Write(Kind.Envelope, "a", envelopes.Envelope));
            Same(hands, session, () => Write(Kind.Hands, new HandFrame()));
            Same(quiet, session, () => Write(Kind.Quiet, quiet.Zones[0]));
            Same(remove, session, () => _outbox.Write(1, Kind.Remove, "a", null, ref movement, 0.25));
            Same(put, session, () => Write(Kind.Put, "a", put.Objects.Value(0)));
            Same(move, session, () => _outbox.Write(1, Kind.Move, "a", null, ref movement, 0.25));
            movement.Rotation = new Quat(); // as in `new Movement { Position = ... }`; the server refuses zeros
            Same(move, session, () => _outbox.Write(1, Kind.Move, "a", null, ref movement, 0.25));
            movement.Moving = true;
            movement.Velocity = new Vec3(1.0, 2.0, 3.0);
            move.Velocities.Add(movement.Velocity);
            move.Velocities.Add(movement.AngularVelocity);
            Same(move, session, () => _outbox.Write(1, Kind.Move, "a", null, ref movement, 0.25));
        }

        private void Same(Command message, Bulk session, Action write)
        {
            message.Session = session;
            message.Sequence = 7;
            message.Time = 0.25;
            message.Ttl = Life;
            Writer wanted = new Writer(), found = new Writer();
            message.Write(wanted);
            write();
            ClientUnit.Holds(_outbox.Take(_batch, 0.25));
            new Commands(Life).Write(found, _batch, session, 7);
            ClientUnit.Equal(
                BitConverter.ToString(wanted.Data, 0, wanted.Count), BitConverter.ToString(found.Data, 0, found.Count));
        }

        private void Write(Kind kind, string name, IMessage message)
        {
            Writer part = new Writer();
            message.Write(part);
            Movement none = new Movement();
            _outbox.Write(1, kind, name, part, ref none, 0.25);
        }

        private void Write(Kind kind, IMessage message)
        {
            Writer part = new Writer();
            part.Array(1);
            message.Write(part);
            _outbox.Write(1, kind, part, 0.25);
        }
    }
}
