"""Benchmarks of the server, with real processes and real sockets.

latency.py, latency_sender.py, echo.py   time from a hand pose to its frame, compared with a bare echo
load.py, many_clients.py, load_observer.py   many clients and updates per second; a client that observes the output
soak.py, soak_game.py, soak_drift.py, visitor.py   a game that runs for long; what changed; a client that is killed
expiry.py, guard_process.py              time from the end of a permit to silence
footprint.py                             start, memory and processor time
viewer.py, viewer_pages.py               cost of the live viewer
faults/, fuzz/                           fault injection; malformed messages
worker_process.py, bare_client.py, positions.py         processes of the benchmark itself; a client on bare sockets
report.py, tables.py, quantiles.py, soak_picture.py   what the benchmarks found
"""
