"""The server: four processes that no client and no plug-in can keep loud. One folder each; none imports another.

server.py    from start to end: what is made, and taken away again
settings.py  what a configuration file may hold
control/     the parent: control socket, leases, who owns the output, status; watches the others
bus/         command socket: decodes, validates, keeps the objects
render/      the loop: scene, solver plug-ins
guard/       owns the device: lets frames through only while permitted and fresh; a spare waits (spare.py)
ipc/         what all of them use: how a process starts, messages, shared memory, logs, scheduling, authentication

`process.py` in each folder is where that process begins. They are joined by shared memory (ipc/shared_memory.py), one
writer each (ipc/messages.py): the newest wins, and none waits.
"""
