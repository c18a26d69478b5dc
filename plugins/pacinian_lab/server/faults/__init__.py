"""Faults around a real server: how soon it is silent, and how soon it works again.

device, logged_backends   devices that log what they are sent   server          a server with such a device
solvers, plugins          a solver that hangs; both as plug-ins  stage           a server, a game and an onlooker
clients, server_parts     one function for each fault            proxy           a line that can be cut
raw_client                a client that may misbehave            game            a game in a process of its own
run, tables               all faults, several times
"""
