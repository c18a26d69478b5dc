using Pacinian.Wire;

namespace Pacinian
{
    /// <summary>What the worker writes and reads with, made once.</summary>
    internal sealed class MessageBuffers
    {
        public readonly Writer Writer = new Writer(1 << 16);
        public readonly Reader Reader = new Reader();
        public readonly Batch Batch = new Batch();
        public readonly Renew Renew = new Renew();
        public IReply Reply;
        public readonly Commands Commands;

        /// <summary>life: how long a command may live [s].</summary>
        public MessageBuffers(double life)
        {
            Commands = new Commands(life);
            Data = new byte[Protocol.MaxReplyBytes];
            Spare = new byte[Protocol.MaxReplyBytes];
        }

        /// <summary>A message as it has come, and room for the next.</summary>
        public byte[] Data { get; private set; }

        public byte[] Spare { get; private set; }

        /// <summary>The next is what was read last.</summary>
        public void Swap()
        {
            byte[] data = Data;
            Data = Spare;
            Spare = data;
        }
    }
}
