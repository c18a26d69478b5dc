"""The bus process: it takes clients' commands, stores their objects, and sends the changes to the renderer.

process.py            begins here: receives, and reports
dispatcher.py         authorises, decodes and carries out each message; answers it, also if it is malformed
message_admission.py  which messages are let in: session, sequence number, age; the rate: ipc/rate_limit.py
coalescing.py         of messages received together, only the newest hands and moves
shared_scene.py       objects, hands and quiet zones of all clients; enforces limits of size and number: of objects
                      (settings.py), of zones (wire/protocol.py)
stored_object.py      one object: its encoding for the renderer; too strong or too large ones are refused
client_hands.py       hands as a client sends them
change_batcher.py     batches of changes for the renderer
pending_changes.py    names of what the renderer lacks; back-pressure: waiting changes have one entry for each object
conversion_queue.py   slow conversions (meshes, sounds), in a thread
field_queries.py      sound-field queries, in slices ("busy" while a client's last one is unanswered)
scene_snapshot.py     what an observer gets of the scene
warmup.py             loads what the first commands need
"""
