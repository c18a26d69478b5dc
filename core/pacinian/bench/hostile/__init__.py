"""A million messages that nobody should send, to a server that sounds meanwhile.

examples.py  one good message of each type    spoil.py   what is done to them
packets.py   what raw sockets are sent        flood.py   a process that sends all that
watch.py     how the server takes it          run.py     both
"""
