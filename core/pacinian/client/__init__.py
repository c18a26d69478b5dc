"""The client: the side of the wire for games and scripts.

client.py              `pacinian.Client`, the user's API
base_client.py         the arguments of a client and their defaults; replaces a lost session, without the scene
server_session.py      one session, from hello to bye
link.py                a socket, its time limits, and why its connection ended
messages.py            arguments of the API as fields of the wire
outbox.py              commands that wait for room in the socket
state_subscription.py  the newest state
server_clock.py        offset of the server's clock, round trips
emergency.py           a stop that needs no session
connection_keys.py     the given connection or its file, with CURVE keys
"""
