using System;
using System.Threading;

namespace Pacinian.Example
{
    /// <summary>A transport that measures the allocations of its thread.</summary>
    public sealed class MeteredTransport : ITransport
    {
        private readonly ITransport _inner = Transports.Make();
        private long _bytes;

        /// <summary>The allocations of its thread up to its last wait [bytes].</summary>
        public long Bytes
        {
            get { return Interlocked.Read(ref _bytes); }
        }

        /// <inheritdoc/>
        public string Open(ConnectionFile file, bool all)
        {
            return _inner.Open(file, all);
        }

        /// <inheritdoc/>
        public Ending Ended()
        {
            return _inner.Ended();
        }

        /// <inheritdoc/>
        public string Problem
        {
            get { return _inner.Problem; }
        }

        /// <inheritdoc/>
        public bool Room(Channel channel)
        {
            return _inner.Room(channel);
        }

        /// <inheritdoc/>
        public bool Send(Channel channel, byte[] data, int count)
        {
            return _inner.Send(channel, data, count);
        }

        /// <inheritdoc/>
        public int Receive(Channel channel, byte[] into)
        {
            return _inner.Receive(channel, into);
        }

        /// <inheritdoc/>
        public void Wait(double seconds)
        {
            Interlocked.Exchange(ref _bytes, GC.GetAllocatedBytesForCurrentThread());
            _inner.Wait(seconds);
        }

        /// <inheritdoc/>
        public void Wake()
        {
            _inner.Wake();
        }

        /// <inheritdoc/>
        public void Close()
        {
            _inner.Close();
        }

        /// <inheritdoc/>
        public void Dispose()
        {
            _inner.Dispose();
        }
    }
}
