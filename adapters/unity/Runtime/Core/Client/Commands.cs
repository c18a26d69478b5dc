using System.Text;
using Pacinian.Wire;

namespace Pacinian
{
    /// <summary>
    /// Writes batches as commands, with the same bytes as the wire's messages. The parts of a batch are already
    /// encoded.
    /// </summary>
    internal sealed class Commands
    {
        private static readonly byte[][] Tags = Words("", "clear", "quiet", "remove", "put", "envelope", "move", "hands");

        private readonly double _life;
        private Bulk _poses, _velocities;

        /// <summary>life: the time to live of a command [s].</summary>
        public Commands(double life)
        {
            _life = life;
        }

        /// <summary>Writes one command. Replaces the writer's content.</summary>
        public void Write(Writer writer, CommandBatch batch, Bulk session, long sequence)
        {
            writer.Clear();
            Kind kind = batch.Kind;
            bool two = kind == Kind.Envelope;
            writer.Map(6 + (kind == Kind.Clear ? 0 : two ? 2 : kind == Kind.Move ? 3 : 1));
            writer.Text("type");
            writer.Word(Tags[(int)kind]);
            writer.Text("session");
            writer.Binary(session);
            writer.Text("sequence");
            writer.Whole(sequence);
            writer.Text("time");
            writer.Real(batch.Time);
            writer.Text("ttl");
            writer.Real(_life);
            writer.Text("id");
            writer.Whole(0);
            switch (kind)
            {
                case Kind.Quiet: Part(writer, "zones", batch); break;
                case Kind.Hands: Part(writer, "hands", batch); break;
                case Kind.Remove: Names(writer, batch); break;
                case Kind.Put: Objects(writer, batch); break;
                case Kind.Envelope: Names(writer, batch); Part(writer, "envelope", batch); break;
                case Kind.Move: Names(writer, batch); Poses(writer, batch); break;
            }
        }

        private static void Part(Writer writer, string name, CommandBatch batch)
        {
            writer.Text(name);
            writer.Append(batch.Parts[0]);
        }

        private static void Names(Writer writer, CommandBatch batch)
        {
            writer.Text("names");
            writer.Array(batch.Names.Count);
            foreach (string name in batch.Names)
            {
                writer.Text(name);
            }
        }

        private static void Objects(Writer writer, CommandBatch batch)
        {
            writer.Text("objects");
            writer.Map(batch.Names.Count);
            for (int i = 0; i < batch.Names.Count; i++)
            {
                writer.Text(batch.Names[i]);
                writer.Append(batch.Parts[i]);
            }
        }

        private void Poses(Writer writer, CommandBatch batch)
        {
            bool moving = false;
            _poses.Clear();
            _velocities.Clear();
            foreach (Movement movement in batch.Movements)
            {
                moving |= movement.Moving;
                _poses.Add(movement.Position);
                _poses.Add(movement.Rotation.Normalised);
                _velocities.Add(movement.Moving ? movement.Velocity : new Vec3());
                _velocities.Add(movement.Moving ? movement.AngularVelocity : new Vec3());
            }
            if (!moving)
            {
                _velocities.Clear();
            }
            writer.Text("poses");
            writer.Binary(_poses);
            writer.Text("velocities");
            writer.Binary(_velocities);
        }

        private static byte[][] Words(params string[] words)
        {
            byte[][] made = new byte[words.Length][];
            for (int i = 0; i < words.Length; i++)
            {
                made[i] = Encoding.ASCII.GetBytes(words[i]);
            }
            return made;
        }
    }
}
