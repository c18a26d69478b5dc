"""Fuzz a server that sounds meanwhile, with a million malformed messages.

run.py        a flood and a control run in turn
flood.py      the process that sends mutated or raw messages
messages.py   one valid message of each type
mutations.py  how messages are mutated, by structure or bytes, from a seed
packets.py    raw TCP bytes: other protocols, wrong lengths, noise
observer.py   the server's output, memory and answers meanwhile
tables.py     results and verdicts
"""
