"""Chooses the cheapest solver that meets the asked error."""

from __future__ import annotations

import functools
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, ClassVar

import numpy as np
from msgspec import Meta

import pacinian as pc
from pacinian.checks import check_number
from pacinian.native import solving as kernels

if TYPE_CHECKING:
    from collections.abc import Iterable

LARGE = 200_000_000  # M M N from which another solver is asked where `lagrange` misses


@dataclass(frozen=True)
class Auto(pc.Solver):
    """One point: `single-focus`. Regions, and no more points than transducers: `lagrange`. Else others.

    error: relative error that will do; a cheaper solver's answer is kept where it is met without a
    limit broken. focus, several, many, dense: the solvers that it passes on to, by name.

    `lagrange` is the pseudo-inverse while no limit is touched, and costs less than any other solver that
    meets 1 %. With more samples than transducers, without regions, `pseudo-inverse` is asked first: it is
    2 to 3 times cheaper, and the optimum too where it keeps the limits. Hundreds of samples closer than
    the array resolves are where `lagrange` gives up at some percent and `lbfgs` gets on, in seconds.
    """

    name: ClassVar[str] = "auto"
    linear: ClassVar[bool] = True
    even: ClassVar[float] = 1.0
    surrounds: ClassVar[bool] = True
    keeps: ClassVar[frozenset[str]] = frozenset({"quiet", "exact"})

    error: Annotated[float, Meta(ge=0.0, le=1.0)] = 1e-3
    focus: str = "single-focus"
    several: str = "lagrange"
    many: str = "pseudo-inverse"
    dense: str = "lbfgs"

    def __post_init__(self) -> None:
        object.__setattr__(self, "error", check_number("error", self.error, low=0.0, high=1.0))

    @functools.cached_property
    def _focus(self) -> pc.Solver:
        return pc.solver(self.focus)

    @functools.cached_property
    def _several(self) -> pc.Solver:
        return pc.solver(self.several)

    @functools.cached_property
    def _dense(self) -> pc.Solver:
        return pc.solver(self.dense)

    @functools.cached_property
    def _many(self) -> pc.Solver:
        return pc.solver(self.many)

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
        count = len(targets.amplitudes)
        solver, why = self._several, "several points"
        if limits.solver_limits or limits.power is not None:
            why = "limits besides that of gains"
        elif targets.regions is not None:
            why = "regions"
        elif count == 1:
            solver, why = self._focus, "one point"
        elif count > len(out) and targets.scale == "exact":
            result = self._many.solve(propagator, targets, limits, warm, budget, out)
            if budget.spent:
                return _named(result._replace(late=True), self._many, "no time for more")
            if self._enough(propagator, targets, limits, out):
                return _named(result, self._many, "more points than transducers, no limit touched")
            out[:] = 0.0
            why = "more points than transducers, at their limit"
        result = solver.solve(propagator, targets, limits, warm, budget, out)
        simple = targets.regions is None and targets.scale == "exact"
        simple = simple and not limits.solver_limits and limits.power is None
        if simple and count <= len(out) and count * count * len(out) > LARGE and not budget.spent:
            return self._better(result, propagator, targets, limits, budget, out)
        return _named(result, solver, why)

    def _better(
        self, first: pc.Result, propagator: pc.Propagator, targets: pc.Targets, limits: pc.Limits,
        budget: pc.Budget, out: pc.Gains,
    ) -> pc.Result:  # fmt: skip
        """The better of the first answer and, where that misses `error`, another."""
        missed = targets.relative_error(propagator.apply(out))
        if missed <= self.error:
            return _named(first, self._several, "several points")
        kept = out.copy()
        out[:] = 0.0
        second = self._dense.solve(propagator, targets, limits, None, budget, out)
        if targets.relative_error(propagator.apply(out)) < missed:
            return _named(second, self._dense, "many points close together")
        out[:] = kept
        return _named(first._replace(late=second.late), self._several, "many points close together")

    def _enough(
        self, propagator: pc.Propagator, targets: pc.Targets, limits: pc.Limits, out: pc.Gains
    ) -> bool:
        """Whether gains, (N,), need no limit, and are optimal (all phases given) or near enough."""
        top = np.inf if limits.gain is None else limits.gain
        if not kernels.peak(out) <= top * top:
            return False
        return not targets.free.any() or targets.relative_error(propagator.apply(out)) <= self.error


def _named(result: pc.Result, solver: pc.Solver, why: str) -> pc.Result:
    note = f"{why}; {result.note}" if result.note else why
    return result._replace(solver=solver.name, note=note)


@pc.hookimpl
def register_solvers() -> Iterable[type[pc.Solver]]:
    """This plug-in's solver."""
    return [Auto]
