"""Benchmarks of the server, with real processes and real sockets.

latency, latency_sender, echo          time from a hand pose to its frame, compared with a bare echo
load, many_clients, load_observer      many clients and updates per second; a client that observes the output
soak, soak_game, soak_drift, visitor   a game that runs for a long time; what changed; a client that is killed
expiry, guard_process                  time from the end of a permit to silence
footprint                              start, memory and processor time
viewer, viewer_pages                   cost of the live viewer
faults/, fuzz/                         fault injection; malformed messages
worker_process, raw_client             processes of the benchmark itself; a client on bare sockets
report, tables, quantiles, soak_picture  what the benchmarks found
"""
