using System;
using System.Threading;
using Pacinian.Wire;

namespace Pacinian
{
    /// <summary>
    /// Sends an emergency stop without a session or worker: the array is silenced at once, whoever owns the output. On the
    /// server's machine it is a datagram; if that is not confirmed in half of the time, and elsewhere, it goes through a
    /// connection of its own. Repeats the attempt until the server has confirmed the stop, or the time is over.
    /// </summary>
    internal sealed class EmergencyStop
    {
        private const double Pause = 0.05; // [s] between two attempts

        private readonly Options _options;
        private readonly Action<string> _done;
        private readonly byte[] _data = new byte[1 << 16];

        private EmergencyStop(Options options, Action<string> done)
        {
            _options = options;
            _done = done;
        }

        /// <summary>
        /// Starts the stop in a thread, and returns it. done: called by that thread with "", or with the reason for a
        /// failure.
        /// </summary>
        public static Thread Begin(Options options, Action<string> done)
        {
            Thread thread = new Thread(new EmergencyStop(options, done).Run)
            {
                IsBackground = true,
                Name = "Pacinian stop",
                Priority = ThreadPriority.AboveNormal,
            };
            thread.Start();
            return thread;
        }

        private void Run()
        {
            string problem;
            try
            {
                double end = _options.Clock() + _options.Timeout;
                if (IsConfirmedWithoutConnection())
                {
                    _done("");
                    return;
                }
                using (ITransport transport = _options.Transport())
                {
                    do
                    {
                        problem = Try(transport, end);
                        if (problem.Length > 0)
                        {
                            transport.Close();
                            transport.Wait(Pause);
                        }
                    }
                    while (problem.Length > 0 && _options.Clock() < end);
                }
            }
            catch (Exception error)
            {
                problem = ErrorMessages.DescribeException(error);
            }
            _done(problem);
        }

        private bool IsConfirmedWithoutConnection()
        {
            string problem;
            ConnectionFile file = ConnectionFile.Read(_options.ConnectionPath, out problem);
            return file != null && file.StopAddress.Length > 0 && StopDatagram.Request(
                file.StopAddress, file.Token.Length > 0 ? file.Token : file.SecretKey, _options.Timeout / 2.0, _options.Clock);
        }

        private string Try(ITransport transport, double end)
        {
            string problem;
            ConnectionFile file = ConnectionFile.Read(_options.ConnectionPath, out problem);
            if (file == null || (problem = transport.Open(file, false)).Length > 0)
            {
                return problem;
            }
            Writer writer = new Writer();
            new Stop { Id = 1 }.Write(writer);
            bool sent = false;
            while (_options.Clock() < end)
            {
                sent = sent || transport.Send(Channel.Control, writer.Data, writer.Count);
                int count = transport.Receive(Channel.Control, _data);
                if (count >= 0)
                {
                    return Confirmed(count) ? "" : "the server would not stop";
                }
                Ending ending = transport.Ended();
                if (ending != Ending.None)
                {
                    return ErrorMessages.DescribeEnding(ending, file.Control, transport.Problem);
                }
                transport.Wait(end - _options.Clock());
            }
            return ErrorMessages.Hangs("stop", _options.Timeout);
        }

        private bool Confirmed(int count)
        {
            IReply reply = null;
            return Protocol.ReadReply(new Reader(), _data, 0, count, ref reply) && reply is Ok;
        }
    }
}
