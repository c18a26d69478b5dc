"""The control process: connections, sessions, output lease, settings and status. It supervises the other processes.

process.py            begins here: the loop that answers requests, also malformed ones; the emergency stop; the log
sockets.py            requests, replies, published state, refused connections
sessions.py           clients from hello to goodbye
output_lease.py       who may sound and until when: arming, takeover, stop; does not log
pending_stops.py      emergency stops that wait until the guard reports silence
selection.py          another solver, backend, technique or intensity while it runs
supervisor.py         starts the other processes, restarts those that end or hang, ends them in order
server_status.py      the published state, from the statuses of all processes
explain_silence.py    why the output is silent, in sentences for people
metrics.py            figures for Prometheus
"""
