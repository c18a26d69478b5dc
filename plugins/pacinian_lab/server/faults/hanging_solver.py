"""A solver that hangs on request, with or without the interpreter lock."""

from __future__ import annotations

import ctypes
import os
import time
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar

import pacinian as pc
from pacinian_lab.server.faults.logging_device import FOLDER

if TYPE_CHECKING:
    from collections.abc import Iterable

STUCK = "stuck"  # while this file exists, the solver never returns
SINCE = "stuck-since"  # file for the time at which the hang began [s]


class Stuck(pc.Solver):
    """Solves as `auto` until it is asked to hang. hold: hang with the interpreter lock held."""

    name: ClassVar[str] = "stuck"

    def __init__(self, hold: bool = False) -> None:
        self.hold = hold
        folder = Path(os.environ[FOLDER])
        self._file, self._since = folder / STUCK, folder / SINCE
        self._solver = pc.solver("auto")

    def solve(
        self,
        propagator: pc.Propagator,
        targets: pc.Targets,
        limits: pc.Limits,
        warm: pc.Solution | None,
        budget: pc.Budget,
        out: pc.Gains,
    ) -> pc.Result:
        """See `pacinian.Solver.solve`."""
        if os.path.exists(self._file) and not os.path.exists(self._since):
            self._since.write_text(repr(time.perf_counter()), encoding="ascii")
        while os.path.exists(self._file):
            if self.hold:
                ctypes.PyDLL(None).sleep(3600)  # called with the lock held
            time.sleep(0.1)
        return self._solver.solve(propagator, targets, limits, warm, budget, out)


@pc.hookimpl
def register_solvers() -> Iterable[type[pc.Solver]]:
    """Return the solver."""
    return [Stuck]
