"""The control process: connections, sessions, output lease, selections and status. It supervises the other processes.

process.py            begins here: the loop and the log; answers malformed requests, and carries out `stop`,
                      `capabilities`, `status` and `select`
sockets.py            requests, replies, published state, refused connections
sessions.py           carries out `hello` (checks the protocol's version), `renew`, `arm`, `disarm`, `reset`, `bye`
client_session.py     a client's session
output_lease.py       who may sound and until when: arming, takeover, stop, fade at `disarm` or `bye`
pending_stops.py      emergency stops that wait until the guard reports silence
selection.py          selects a solver, backend, technique or intensity while the server runs
supervisor.py         starts the other processes, restarts those that end or hang, ends them in order
process_statuses.py   reads the statuses of the other processes
state_builder.py      builds the published state from them
explain_silence.py    why the output is silent, in sentences for people
metrics.py            figures for Prometheus
"""
