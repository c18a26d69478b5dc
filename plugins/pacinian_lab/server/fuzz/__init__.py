"""Malformed messages by the million, to a server that sounds meanwhile.

messages    one good message of each type    mutations   how messages are spoiled
packets     bytes for raw TCP connections    flood       the process that sends all that
observer    how the server takes it          run         a flood and a control run in turn
"""
