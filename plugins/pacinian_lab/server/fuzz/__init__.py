"""Fuzz a server that sounds meanwhile, with a million malformed messages.

messages    one valid message of each type   mutations   how messages are mutated
packets     bytes for raw TCP connections    flood       the process that sends all that
observer    how the server takes it          run         a flood and a control run in turn
"""
