"""Inter-process basics: how the server's processes start, share memory, keep time, log and authenticate each other.

messages.py           what the processes tell each other: permit, frame, changes, statuses; in how much memory
shared_memory.py      memory with one writer, where the newest value wins
wake_pipe.py          ends the wait of another process
launched_child.py     a child, as its parent sees it: its start by spawn or fork, its configuration and its end
parent_link.py        a child's link to its parent: receives the configuration, notices the parent's end
launch_config.py      the configuration of a new child
child_pipe.py         the pipes that hold a child's configuration, and end it when they close
processes.py          spawns or forks a process, although no file descriptor is left
system_setup.py       asks of the operating system: file descriptors, memory, signals, systemd
ports.py              whether a TCP port is free; binds sockets
hang_detection.py     for how long a process may send no heartbeat, from `hang_timeout` (settings.py)
scheduling.py         priority, real-time class and processor affinity
logs.py               logging to standard error
log_lines.py          a line of the log, as text or JSON
auth.py               keys, tokens and CURVE: who may connect
zap.py                the thread that answers ZeroMQ's questions about new connections
file_lock.py          one server for each connection file
clock_offset.py       a client's clock offset
rate_limit.py         token buckets: messages a second of each connection
plugin_list.py        lists the plug-ins that can be selected, and creates them
refused_setting.py    a setting that a solver or a backend refuses, reported to control
"""
