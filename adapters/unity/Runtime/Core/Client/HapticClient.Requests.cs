using System;
using System.Threading;
using Pacinian.Wire;

namespace Pacinian
{
    /// <summary>Requests. If the server refuses one, <see cref="Refused"/> is raised.</summary>
    public sealed partial class HapticClient
    {
        private const double ChangeTimeout = 12.0; // [s] longest time to open a solver or backend

        /// <summary>
        /// Arms the output: this client's scene is felt for as long as the client ticks. take: takes the output from
        /// its owner. resume: after a standstill of more than the lease, the next tick lets the output sound again; if
        /// false, arm again.
        /// </summary>
        public bool Arm(bool take = false, bool resume = true)
        {
            return AddRequest("arm", new Arm { Take = take, Resume = resume });
        }

        /// <summary>Disarms: the sound fades, and the output is released.</summary>
        public bool Disarm()
        {
            return AddRequest("disarm", new Disarm());
        }

        /// <summary>Allows arming again after an emergency stop or a fault.</summary>
        public bool Reset()
        {
            return AddRequest("reset", new Reset());
        }

        /// <summary>
        /// Changes the solver, the backend, the default technique or the intensity. What is null stays. intensity:
        /// factor on all radiation pressures, 0..1.
        /// </summary>
        public bool Select(
            Choice solver = null, Choice backend = null, ITechnique technique = null, double? intensity = null)
        {
            Select select = new Select
            {
                Solver = solver, Backend = backend, Technique = technique, Intensity = intensity,
            };
            return Add(new PendingRequest("select", select, ChangeTimeout));
        }

        /// <summary>
        /// Requests the complex sound pressures [Pa] that are now emitted at points (K, 3) [m]. answer: called on the
        /// game's thread; its argument is null if there is no answer.
        /// </summary>
        public bool Field(Bulk points, Action<Pressures> answer)
        {
            Field field = new Field { Ttl = _shared.Options.Life };
            if (points.Count > 0)
            {
                field.Points.Set(points.Data, 0, points.Count);
            }
            return Add(new PendingRequest("field", field, _shared.Options.Timeout, answer));
        }

        /// <summary>
        /// Emergency stop: silences the array at once, whoever owns the output, until <see cref="Reset"/>. May be
        /// called from any thread. Uses its own connection, and therefore also works without a session, before Start
        /// and after Dispose. If the server does not confirm the stop, the next <see cref="Tick"/> raises
        /// <see cref="Refused"/>. refused: is called then, too, at once and on another thread; for programs that do not tick.
        /// </summary>
        public void Stop(Action<Refusal> refused = null)
        {
            _shared.PendingStops.Begin();
            Thread stop = EmergencyStop.Begin(_shared.Options, problem => Stopped(problem, refused));
            lock (_stops)
            {
                _stops.RemoveAll(old => !old.IsAlive);
                _stops.Add(stop);
            }
        }

        private void Stopped(string problem, Action<Refusal> refused)
        {
            if (problem.Length > 0)
            {
                Interlocked.Exchange(ref _stopProblem, problem);
                refused?.Invoke(ErrorMessages.Unstopped(problem));
            }
            _shared.PendingStops.End();
            _worker.Wake();
        }

        private bool AddRequest(string what, Request request)
        {
            return Add(new PendingRequest(what, request, _shared.Options.Timeout));
        }

        private bool Add(PendingRequest request)
        {
            return IsGamesThread(request.What)
                && ReportNoSession(request.What, WakeWorker(_shared.Requests.Add(_sessionState.Session, request)));
        }
    }
}
