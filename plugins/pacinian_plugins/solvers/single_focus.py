"""A single focus in closed form."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

import numpy as np

import pacinian as pc

if TYPE_CHECKING:
    from collections.abc import Iterable


@dataclass(frozen=True)
class SingleFocus(pc.Solver):
    """All transducers in phase at the focus, with equal strength: g = t u* / sum |b|, where u = b / |b|.

    No other gains with |g| <= limit make a stronger focus. Of several points, only the strongest one that sound
    reaches is made. Transducers that do not reach it stay off. A fixed phase is met; a free one is 0.
    """

    name: ClassVar[str] = "single-focus"
    linear: ClassVar[bool] = True
    max_uniform_points: ClassVar[float] = np.inf

    def solve(
        self,
        propagator: pc.Propagator,
        targets: pc.Targets,
        limits: pc.Limits,
        warm: pc.Solution | None,
        budget: pc.Budget,
        out: pc.Gains,
    ) -> pc.Result:
        """Write the gains of the strongest target; see `pacinian.Solver.solve`."""
        reached = np.abs(propagator.B).max(axis=1) > 0.0
        m = int(np.argmax(targets.amplitudes * reached))
        b = propagator.B[m]  # (N,)
        size = np.abs(b)  # [Pa]
        reach = float(size.sum(dtype=np.float64))  # [Pa] at full drive
        if not reach:
            return pc.Result(note="no transducer reaches the focus")
        wanted = targets.complex(np.zeros(len(targets.amplitudes)))[m] / reach  # as a complex gain
        top = limits.top_gain
        limited = bool(abs(wanted) > top)
        if limited:
            wanted *= top / abs(wanted)
        np.multiply(b.conj(), wanted, out=out, casting="unsafe")
        out /= np.where(size > 0.0, size, 1.0)
        left = len(targets.amplitudes) - 1
        return pc.Result(limited=limited, note=f"{left} weaker points left out" if left else "")


@pc.hookimpl
def register_solvers() -> Iterable[type[pc.Solver]]:
    """Return this plug-in's solver."""
    return [SingleFocus]
