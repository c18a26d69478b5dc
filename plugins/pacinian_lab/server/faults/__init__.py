"""Inject faults around a real server: measure how soon it is silent, and how soon it works again.

run.py                 list of all faults with their documented bounds; each several times
client_faults.py       faults of a client or connection: killed, stopped, half open, many topics
server_faults.py       faults of the server or device: killed, stopped, hung processes; swaps
rig.py                 server, game, onlooker; times until silence and until it works again
server.py              a real server with the logging device
game.py                a game in its own process
proxy.py               a connection that can be cut
misbehaving_client.py  a client that sends raw messages, or is silent
logging_device.py      a device that logs to a file; can be unplugged, can block
logged_backends.py     installed backends with such a log, for swaps
hanging_solver.py      a solver that hangs, with or without the interpreter lock
plugins.py             installs these devices and the solver for the server
tables.py              results in a terminal
"""
