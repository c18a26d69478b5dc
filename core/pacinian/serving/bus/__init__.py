"""The bus process: it takes clients' commands, stores their objects, and sends the changes to the renderer.

process.py, warmup.py          begins here; loads what the first commands need
dispatcher.py, admission.py, coalescing.py   carries out each message; lets it in; drops what is out of date
shared_scene.py, stored_object.py, client_hands.py   objects, zones and hands that clients have put
change_batcher.py, pending_changes.py   what goes to the renderer
conversion_queue.py, field_queries.py, scene_snapshot.py   slow conversions; field queries; what observers get
"""
