"""Benchmarks of the server, with real processes and real sockets.

latency, sender, echo           time from a hand pose to its frame, compared with a bare echo
load, many_clients, observer    many clients and updates per second; a client that observes the output
soak, game, visitor, drift      a game that runs for a long time; a client that is killed; what changed
expiry, guard_process           time from the end of a permit to silence
viewer, viewer_pages            cost of the live viewer
faults/, fuzz/                  fault injection; malformed messages
worker_process, raw_client      processes of the benchmark itself; a client on bare sockets
report, tables, picture         results
"""
