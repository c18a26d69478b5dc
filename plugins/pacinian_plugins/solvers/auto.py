"""Chooses the cheapest solver that is exact for the problem."""

from __future__ import annotations

import functools
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

import pacinian as pc

if TYPE_CHECKING:
    from collections.abc import Iterable


@dataclass(frozen=True)
class Auto(pc.Solver):
    """One point: `single-focus`. More: `lagrange`, which is the pseudo-inverse while no limit is touched.

    focus, several: the solvers that it passes on to, by name.
    """

    name: ClassVar[str] = "auto"

    focus: str = "single-focus"
    several: str = "lagrange"

    @functools.cached_property
    def _focus(self) -> pc.Solver:
        return pc.solver(self.focus)

    @functools.cached_property
    def _several(self) -> pc.Solver:
        return pc.solver(self.several)

    def solve(
        self,
        propagator: pc.Propagator,
        targets: pc.Targets,
        limits: pc.Limits,
        warm: pc.Solution | None,
        budget: pc.Budget,
        out: pc.Gains,
    ) -> pc.Result:
        """Pass the problem on; see `pacinian.Solver.solve`."""
        one = len(targets.amplitudes) == 1
        solver, why = (self._focus, "one point") if one else (self._several, "several points")
        result = solver.solve(propagator, targets, limits, warm, budget, out)
        note = f"{why}; {result.note}" if result.note else why
        return result._replace(solver=solver.name, note=note)


@pc.hookimpl
def register_solvers() -> Iterable[type[pc.Solver]]:
    """This plug-in's solver."""
    return [Auto]
