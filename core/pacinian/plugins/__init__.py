"""The interfaces that plug-ins implement, and their discovery.

solver.py             `Solver`: interface of solvers; what one promises (`linear`, `keeps`); `Result`
backend.py            `Backend`: interface of devices; `Capability` (rate, levels, channels), `Frame`
hookspecs.py          the hooks: register_solvers, register_backends, register_commands
registry.py           finds plug-ins by entry points; `solver(name)`, `backend(name)`; name clashes, versions
device_discovery.py   lists connected devices of all backends
options.py            which options a server's client may set: those with bounds

No other solver replaces one that is slow or missing. `rendering/solve_deadline.py` chooses when a solve must end.
"""
