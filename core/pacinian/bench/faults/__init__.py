"""What goes wrong around a server, done to a real one: how soon it is silent, how soon it is well again.

device.py   a device that remembers all it was told     plugins.py   it and a bad solver, as plug-ins
server.py   a server to be broken                       peer.py      a client that may misbehave
game.py     a game in a process of its own              proxy.py     a wire that can be cut
faults/     one function each                           run.py       all of them, again and again
"""
