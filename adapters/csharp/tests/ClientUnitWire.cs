using System;
using System.Collections.Generic;
using Pacinian.Wire;

namespace Pacinian.Tests
{
    /// <summary>A scripted transport. Answers: the messages of the control socket.</summary>
    internal sealed class Scripted : ITransport
    {
        public readonly Queue<IMessage> Answers = new Queue<IMessage>();
        public Ending End;
        public string Why = "";
        public bool Full;
        public int Opened;
        public IMessage Last;
        private readonly List<string> _said = new List<string>();

        public string Said()
        {
            string said = string.Join(" ", _said.ToArray());
            _said.Clear();
            return said;
        }

        public string Open(ConnectionFile file, bool all)
        {
            Opened++;
            Answers.Clear();
            return "";
        }

        public Ending Ended()
        {
            return End;
        }

        public string Problem
        {
            get { return Why; }
        }

        public bool Room(Channel channel)
        {
            return !Full;
        }

        public bool Send(Channel channel, byte[] data, int count)
        {
            IControl message = null;
            Command command = null;
            ClientUnit.Holds(channel == Channel.Control
                ? Protocol.ReadControl(new Reader(), data, 0, count, ref message)
                : Protocol.ReadCommand(new Reader(), data, 0, count, ref command));
            Last = (IMessage)message ?? command;
            _said.Add(Last.GetType().Name);
            return true;
        }

        public int Receive(Channel channel, byte[] into)
        {
            if (channel != Channel.Control || Answers.Count == 0)
            {
                return -1;
            }
            Writer writer = new Writer();
            Answers.Dequeue().Write(writer);
            Buffer.BlockCopy(writer.Data, 0, into, 0, writer.Count);
            return writer.Count;
        }

        public void Wait(double seconds)
        {
        }

        public void Wake()
        {
        }

        public void Close()
        {
        }

        public void Dispose()
        {
        }
    }
}
