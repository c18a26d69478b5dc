namespace Pacinian.Haptics
{
    /// <summary>Sends changes of solver, backend and intensity to the server, at a limited rate.</summary>
    internal sealed class SelectionSender
    {
        private const double Pause = 0.1; // [s] shortest time between two changes

        private string _solver = "", _backend = "";
        private float _intensity = -1f;
        private double _next;

        /// <summary>Forgets what was sent, because a new session starts.</summary>
        public void Forget()
        {
            _solver = _backend = "";
            _intensity = -1f;
            _next = 0.0;
        }

        /// <summary>
        /// Sends the values that differ from the last ones sent. solver, backend: "" leaves the server's unchanged.
        /// now: [s].
        /// </summary>
        public void Send(HapticClient client, string solver, string backend, float intensity, double now)
        {
            bool solving = solver.Length > 0 && solver != _solver, sending = backend.Length > 0 && backend != _backend;
            bool stronger = intensity != _intensity;
            if (now < _next || !(solving || sending || stronger))
            {
                return;
            }
            _next = now + Pause;
            if (stronger)
            {
                client.Select(intensity: intensity);
            }
            if (solving || sending)
            {
                client.Select(
                    solving ? new Wire.Choice { Name = solver } : null,
                    sending ? new Wire.Choice { Name = backend } : null);
            }
            _solver = solver;
            _backend = backend;
            _intensity = intensity;
        }
    }
}
