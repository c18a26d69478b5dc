"""Inter-process basics: how the server's processes start, share memory, keep time, log and authenticate each other.

child_process.py, child_pipe.py, spawned_process.py   how control starts a process, tells it its settings and ends it
scheduling.py, memory.py, logs.py, log_lines.py   priority, memory and log of a process
shared_memory.py, messages.py, wake_pipe.py   memory with one writer; what it holds; what ends a wait
auth.py, zap.py, file_lock.py  who may connect; one server for each connection file
clocks.py, plugin_list.py      clients' clocks and rates; what can be selected
"""
