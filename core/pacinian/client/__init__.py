"""The client: the side of the wire for games and scripts.

client.py                 `pacinian.Client`, the user's API: put, move, hands, arm, renew, stop, select
timeouts.py               default time limits: of a reply, of a change of the solver or backend
reconnecting_client.py    arguments of a client and their defaults; connects, and reconnects after a lost session
server_session.py         one session, from hello to bye: sequence numbers, replies, renewal at an eighth of the lease
link.py                   the ZeroMQ socket: heartbeats, limits of the time to connect, why a connection ended
messages.py               arguments of the API as wire messages, in batches that fit a message
outbox.py                 commands that wait for room; newer ones replace older ones
state_subscription.py     reads the newest state, skips older ones
server_clock.py           offset of the server's clock, round-trip times
emergency_stop.py         `emergency_stop`: needs no session; datagram, or control socket
connection_keys.py        the given connection or its file, with CURVE keys
"""
