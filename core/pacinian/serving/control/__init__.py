"""The control process: connections, sessions, output lease, settings and status. It supervises the other processes.

process.py                     begins here: the loop that answers requests
sockets.py, sessions.py        requests and replies; clients, from hello to goodbye
output_lease.py, selection.py  who may sound and until when; another solver, backend or intensity
supervisor.py                  starts, restarts and ends the other processes
server_status.py, explain_silence.py, metrics.py   the published state; why the output is silent; figures for Prometheus
"""
