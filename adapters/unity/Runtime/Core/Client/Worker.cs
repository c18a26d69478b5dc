using System;
using System.Threading;

namespace Pacinian
{
    /// <summary>
    /// The thread that owns the sockets. It has no reference to the client, so that a client that was not disposed can
    /// be collected; its finaliser then ends the thread.
    /// </summary>
    internal sealed class Worker
    {
        private const double MaxFarewell = 0.2; // [s] that a goodbye may take

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

        /// <summary>Wakes the thread because there is something to do.</summary>
        public void Wake()
        {
            ITransport transport = _transport;
            if (transport != null)
            {
                transport.Wake();
            }
        }

        /// <summary>Asks the thread to end. Does not wait.</summary>
        public void End()
        {
            _end = true;
            Wake();
        }

        /// <summary>Waits for the end of the thread, for this time at most [ms]. Returns whether it has ended.</summary>
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
                    RunSessionLoop(new SessionLoop(_shared, transport, ConnectionFile.Read), transport);
                }
            }
            catch (Exception error)
            {
                problem = ErrorMessages.DescribeException(error);
            }
            finally
            {
                _shared.EndSession(problem, false, false);
                _shared.Inbox.SetSessionState(SessionState.None(ClientStatus.Stopped, problem));
            }
        }

        private void RunSessionLoop(SessionLoop sessions, ITransport transport)
        {
            Func<double> clock = _shared.Options.Clock;
            while (!_end)
            {
                double now = clock();
                _shared.Heartbeat.RecordStep(now);
                sessions.Step(now, _shared.Heartbeat.LastTick);
                transport.Wait(sessions.MaxWait(now));
            }
            double due = clock() + MaxFarewell;
            if (sessions.SayGoodbye(clock()))
            {
                while (!sessions.GoodbyeAnswered && clock() < due)
                {
                    transport.Wait(due - clock());
                    sessions.Step(clock(), double.NegativeInfinity);
                }
            }
        }
    }
}
