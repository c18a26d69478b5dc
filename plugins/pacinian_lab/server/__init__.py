"""Benchmarks of the server, with real processes and real sockets.

latency.py         time from a hand pose to its frame
latency_sender.py  the game that sends these poses, in its own process
echo.py            the baseline of latency: a socket that echoes
load.py            1 to 64 clients, up to 10,000 updates per second and more
many_clients.py    these clients, in one process
load_observer.py   owns the output under load, observes it, pings the control socket
positions.py       positions that encode when they were sent, for the age of what is felt
soak.py            a server that runs for long: memory, files, ticks, window by window
soak_game.py       the game of the soak: hand, balls, nonsense messages, changes of solver
soak_drift.py      verdicts of the soak: has memory, files, ticks, ages grown?
soak_picture.py    the soak as a picture
killed_client.py   a client of the soak that is killed while it moves its object
expiry.py          time from the end of a permit to silence
guard_process.py   a guard process without a server, for expiry.py
footprint.py       time to start, memory, processor time
viewer.py          ticks with the viewer closed and open; frames of a page
viewer_pages.py    a page that only reads, and one in Chromium
worker_process.py  a process of the benchmark, by JSON lines
bare_client.py     a client on bare sockets
report.py          verdicts, JSON
tables.py          results in a terminal
quantiles.py       quantiles of times
faults/            fault injection
fuzz/              malformed messages
"""
