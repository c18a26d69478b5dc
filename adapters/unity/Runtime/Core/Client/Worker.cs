using System;
using System.Threading;

namespace Pacinian
{
    /// <summary>
    /// The thread that owns the sockets. It holds nothing of the client that the game holds, so that a client which is
    /// forgotten can be collected, and ends it.
    /// </summary>
    internal sealed class Worker
    {
        private const double Farewell = 0.2; // [s] that a goodbye may take

        private readonly SharedState _shared;
        private volatile ITransport _transport;
        private volatile bool _end;
        private Thread _thread;

        public Worker(SharedState shared)
        {
            _shared = shared;
        }

        public void Start()
        {
            _thread = new Thread(Run) { IsBackground = true, Name = "Pacinian" };
            _thread.Start();
        }

        /// <summary>There is something to do.</summary>
        public void Wake()
        {
            ITransport transport = _transport;
            if (transport != null)
            {
                transport.Wake();
            }
        }

        /// <summary>It is to end; does not wait for that.</summary>
        public void End()
        {
            _end = true;
            Wake();
        }

        /// <summary>Waits for its end, at most so long [ms]; whether it has ended.</summary>
        public bool Join(int milliseconds)
        {
            return _thread == null || _thread.Join(milliseconds);
        }

        private void Run()
        {
            string problem = "";
            try
            {
                using (ITransport transport = _shared.Options.Transport())
                {
                    _transport = transport;
                    Serve(new Sessions(_shared, transport, ConnectionFile.Read), transport);
                }
            }
            catch (Exception error)
            {
                problem = Problems.Of(error);
            }
            finally
            {
                _shared.End(problem, false, false);
                _shared.Inbox.Stand(Standing.None(ClientStatus.Stopped, problem));
            }
        }

        private void Serve(Sessions sessions, ITransport transport)
        {
            Func<double> clock = _shared.Options.Clock;
            while (!_end)
            {
                double now = clock();
                _shared.Heartbeat.Step(now);
                sessions.Step(now, _shared.Heartbeat.LastTick);
                transport.Wait(sessions.Patience(now));
            }
            double due = clock() + Farewell;
            if (sessions.Leave(clock()))
            {
                while (!sessions.Left && clock() < due)
                {
                    transport.Wait(due - clock());
                    sessions.Step(clock(), double.NegativeInfinity);
                }
            }
        }
    }
}
