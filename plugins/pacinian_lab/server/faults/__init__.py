"""Inject faults around a real server: measure how soon it is silent, and how soon it works again.

logging_device.py, logged_backends.py   devices that log what they receive
hanging_solver.py, plugins.py     a solver that hangs; the plug-ins of this folder
server.py                         a server with such a device
rig.py                            a server, a game and an onlooker
client_faults.py, server_faults.py   one function for each fault
proxy.py                          a connection that can be cut
misbehaving_client.py             a client that may misbehave
game.py                           a game in a separate process
run.py, tables.py                 all faults, with repeats
"""
