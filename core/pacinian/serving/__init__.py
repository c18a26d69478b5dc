"""The server: four processes that no client and no plug-in can keep loud.

server.py    from start to end: what is made, and taken away again
control.py   the parent: control socket, leases, ownership, state; watches the others
bus.py       command socket: decodes, validates, keeps the objects
render.py    the loop: scene, solver plug-ins
guard.py     owns the device: lets frames through only while permitted and fresh; a spare waits (spare.py)

They are joined by shared memory (memory.py), one writer each (messages.py): the newest wins, and none waits.
"""
