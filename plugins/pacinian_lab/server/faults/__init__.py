"""Inject faults around a real server: measure how soon it is silent, and how soon it works again.

device, logged_backends   devices that log what they receive     server          a server with such a device
solvers, plugins          a solver that hangs; both as plug-ins  stage           a server, a game and an onlooker
clients, server_parts     one function for each fault            proxy           a connection that can be cut
raw_client                a client that may misbehave            game            a game in a separate process
run, tables               all faults, with repeats
"""
