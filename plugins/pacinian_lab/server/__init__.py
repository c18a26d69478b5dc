"""The server under measurement, with real processes and real sockets.

latency, sender, echo           from a hand's pose to its frame, beside a bare echo
load, many_clients, observer    many clients and updates a second; who looks on
soak, game, visitor, drift      a game that runs for long; a client that is killed; what changed
expiry, guard_process           from the end of a permit to silence
viewer, viewer_pages            what the live viewer costs
faults/, fuzz/                  faults injected; malformed messages
worker_process, raw_client      a process of the benchmark's own; a client on bare sockets
report, tables, picture         results
"""
