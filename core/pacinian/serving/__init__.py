"""The server: control, bus, render, guard and a spare guard, which no client and no plug-in can keep loud.

Each of the four kinds of process has a folder; none imports another.

  server.py    starts and ends the server; decides whether its first processes are forked or spawned; tells systemd
               when the server is ready
  settings.py  contents of a configuration file, with all limits and times that it can set
  control/     the parent: control socket, sessions, output lease, selections, status; supervises the others
  bus/         command socket: decodes and validates commands, stores the objects
  render/      the loop: scene, solver plug-ins
  guard/       owns the device: lets frames through only while permitted and fresh; a spare waits (spare_guard.py)
  ipc/         common to all: start of a process, messages, shared memory, logs, scheduling, authentication

Each process begins in the `process.py` of its folder. They exchange data through shared memory (ipc/shared_memory.py),
with one writer for each file (ipc/messages.py). The newest value wins, and no process waits for another.
"""
