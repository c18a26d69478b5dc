"""AUTD3 arrays, through the AUTD3 project's own packages: docs/autd3.md.

backend.py              the backend: options, units, levels, rows
units.py                poses of units; transducers to channels
levels.py               Pacinian's levels as phases and pulse widths
row_commands.py         rows as commands; STM in the units' memory
repeat_detector.py      rows that repeat, which units play by themselves
commands.py             commands: levels without ramps (silencer off), silence
transport_interface.py  interface of the ways to units
open_transport.py       chooses one by `link`: udp, simulator, server, loopback, emulator
udp_transport.py        units on a network, or a stand-in; in a thread
emulated.py             the AUTD3 project's emulator
packages.py             imports its packages, which are optional
error_advice.py         what their errors mean
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import pacinian as pc
from pacinian_plugins.backends.autd3.backend import Autd3

if TYPE_CHECKING:
    from collections.abc import Iterable

__all__ = ["Autd3", "register_backends"]


@pc.hookimpl
def register_backends() -> Iterable[type[pc.Backend]]:
    """Return this plug-in's backend."""
    return [Autd3]
