"""The client: a game's or a script's side of the wire.

client.py      `pacinian.Client`: what users call         connected.py   lost, and made anew
dialogue.py    one session, from hello to bye             link.py        a socket, and the end of its connection
messages.py    what users give, as the wire's fields      outbox.py      what the socket had no room for
watching.py    the newest state                           timing.py      round trips, the server's clock
emergency.py   a stop that needs no session               keys.py        CURVE keys from files
"""
