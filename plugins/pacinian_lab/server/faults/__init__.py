"""Inject faults around a real server: measure how soon it is silent, and how soon it works again.

logging_device, logged_backends   devices that log what they receive
hanging_solver, plugins           a solver that hangs; the plug-ins of this folder
server                            a server with such a device
rig                               a server, a game and an onlooker
client_faults, server_faults      one function for each fault
proxy                             a connection that can be cut
raw_client                        a client that may misbehave
game                              a game in a separate process
run, tables                       all faults, with repeats
"""
