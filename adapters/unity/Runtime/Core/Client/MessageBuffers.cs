using Pacinian.Wire;

namespace Pacinian
{
    /// <summary>The worker's buffers for writing and reading, allocated once.</summary>
    internal sealed class MessageBuffers
    {
        public readonly Writer Writer = new Writer(1 << 16);
        public readonly Reader Reader = new Reader();
        public readonly CommandBatch Batch = new CommandBatch();
        public readonly Renew Renew = new Renew();
        public IReply Reply;
        public readonly Commands Commands;

        /// <summary>life: the time to live of a command [s].</summary>
        public MessageBuffers(double life)
        {
            Commands = new Commands(life);
            Data = new byte[Protocol.MaxReplyBytes];
            Spare = new byte[Protocol.MaxReplyBytes];
        }

        /// <summary>The bytes of a received message. `Spare` has room for the next.</summary>
        public byte[] Data { get; private set; }

        public byte[] Spare { get; private set; }

        /// <summary>Exchanges `Data` and `Spare`.</summary>
        public void Swap()
        {
            byte[] data = Data;
            Data = Spare;
            Spare = data;
        }
    }
}
