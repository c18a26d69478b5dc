namespace Pacinian.Haptics
{
    /// <summary>Solver, backend and intensity as the server was last told: a change is told, and not too often.</summary>
    internal sealed class Changing
    {
        private const double Pause = 0.1; // [s] between two changes

        private string _solver = "", _backend = "";
        private float _intensity = -1f;
        private double _next;

        /// <summary>Another server, or the same anew: it knows nothing.</summary>
        public void Forget()
        {
            _solver = _backend = "";
            _intensity = -1f;
            _next = 0.0;
        }

        /// <summary>Tells what is not known. solver, backend: "" as it is. now: [s].</summary>
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
