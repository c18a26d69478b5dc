using System;
using System.Threading;
using Pacinian.Wire;

namespace Pacinian
{
    /// <summary>What is asked of the server. What it would not do is told by <see cref="Refused"/>.</summary>
    public sealed partial class HapticClient
    {
        private const double Change = 12.0; // [s] that another solver or backend may take to be ready

        /// <summary>
        /// This client's scene is to be felt, for as long as it ticks. take: from its owner, if need be. resume: if the game
        /// stands still for longer than its lease, it sounds again when it goes on; otherwise it is to be armed again.
        /// </summary>
        public bool Arm(bool take = false, bool resume = true)
        {
            return Ask("arm", new Arm { Take = take, Resume = resume });
        }

        /// <summary>Silence, softly; the output is let go.</summary>
        public bool Disarm()
        {
            return Ask("disarm", new Disarm());
        }

        /// <summary>After an emergency stop or a fault: it may be armed again.</summary>
        public bool Reset()
        {
            return Ask("reset", new Reset());
        }

        /// <summary>
        /// Another solver, backend, technique of objects that have none of their own, or strength, while it runs; what is
        /// not given stays. intensity: factor on all radiation pressures, 0..1.
        /// </summary>
        public bool Select(
            Choice solver = null, Choice backend = null, ITechnique technique = null, double? intensity = null)
        {
            Select select = new Select
            {
                Solver = solver, Backend = backend, Technique = technique, Intensity = intensity,
            };
            return Add(new PendingRequest("select", select, Change));
        }

        /// <summary>
        /// Complex sound pressures [Pa] at points (K, 3) [m] of what is emitted now. answer: is given them, on the game's
        /// thread; null if there is none.
        /// </summary>
        public bool Field(Bulk points, Action<Pressures> answer)
        {
            Field field = new Field { Ttl = _shared.Options.Life };
            field.Points.Set(points.Data, 0, points.Count);
            return Add(new PendingRequest("field", field, _shared.Options.Timeout, answer));
        }

        /// <summary>
        /// Emergency stop: silence at once, whoever owns the output, until <see cref="Reset"/>. From any thread, by a
        /// connection of its own: also without a session, and before the start or after the end.
        /// </summary>
        public void Stop()
        {
            _shared.PendingStops.Begin();
            Thread stop = EmergencyStop.Begin(_shared.Options, Stopped);
            lock (_stops)
            {
                _stops.RemoveAll(old => !old.IsAlive);
                _stops.Add(stop);
            }
        }

        private void Stopped(string problem)
        {
            if (problem.Length > 0)
            {
                _shared.Inbox.Refuse(Problems.Unstopped(problem));
            }
            _shared.PendingStops.End();
            _worker.Wake();
        }

        private bool Ask(string what, Request request)
        {
            return Add(new PendingRequest(what, request, _shared.Options.Timeout));
        }

        private bool Add(PendingRequest request)
        {
            return IsGamesThread(request.What) && Told(request.What, Woken(_shared.Requests.Add(_standing.Session, request)));
        }
    }
}
