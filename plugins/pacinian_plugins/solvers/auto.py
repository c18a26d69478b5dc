"""Chooses the cheapest solver that meets the requested error."""

from __future__ import annotations

import functools
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, ClassVar

from msgspec import Meta

import pacinian as pc
from pacinian.argument_checks import check_number
from pacinian.native import solving as kernels

if TYPE_CHECKING:
    from collections.abc import Iterable

# M M N above which another solver is tried if `lagrange` misses the error.
MIN_DENSE_WORK = 200_000_000


@dataclass(frozen=True)
class Auto(pc.Solver):
    """Selects a solver: `single-focus` for one point, `lagrange` for regions or several points, sometimes others.

    error: relative error that suffices; the solution of a cheaper solver is kept if it meets this error and
    no limit is broken. focus, several, many, dense: names of the solvers to select from.

    `lagrange` is the pseudo-inverse while no limit is reached, and costs less than any other solver that
    meets 1 %. With more samples than transducers and no regions, `pseudo-inverse` runs first: it is
    2 to 3 times cheaper, and also optimal if it keeps the limits. For hundreds of samples closer together
    than the array resolves, `lagrange` stops at an error of some percent; `lbfgs` then improves it, in seconds.
    """

    name: ClassVar[str] = "auto"
    linear: ClassVar[bool] = True
    max_uniform_points: ClassVar[float] = 1.0
    surrounds: ClassVar[bool] = True
    keeps: ClassVar[frozenset[str]] = frozenset({"quiet", "exact"})

    error: Annotated[float, Meta(ge=0.0, le=1.0)] = 1e-3
    focus: str = "single-focus"
    several: str = "lagrange"
    many: str = "pseudo-inverse"
    dense: str = "lbfgs"

    def __post_init__(self) -> None:
        object.__setattr__(self, "error", check_number("error", self.error, low=0.0, high=1.0))
        _ = self._focus, self._several  # loaded now, so that the first solve does not take longer

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
        """Solve with the selected solver; see `pacinian.Solver.solve`."""
        count = len(targets.amplitudes)
        solver, why = self._several, "several points"
        if limits.couples_gains:
            why = "limits besides that of gains"
        elif targets.regions is not None:
            why = "regions"
        elif count == 1:
            solver, why = self._focus, "one point"
        elif count > len(out) and targets.scale == "exact":
            result = self._many.solve(propagator, targets, limits, warm, budget, out)
            if budget.spent:
                return _label_result(result._replace(late=True), self._many, "no time for more")
            if self._suffices(propagator, targets, limits, out):
                return _label_result(
                    result, self._many, "more points than transducers, no limit touched"
                )
            out[:] = 0.0
            why = "more points than transducers, at their limit"
        result = solver.solve(propagator, targets, limits, warm, budget, out)
        simple = targets.regions is None and targets.scale == "exact"
        simple = simple and not limits.couples_gains
        if (
            simple
            and count <= len(out)
            and count * count * len(out) > MIN_DENSE_WORK
            and not budget.spent
        ):
            return self._improve(result, propagator, targets, limits, budget, out)
        return _label_result(result, solver, why)

    def _improve(
        self, first: pc.Result, propagator: pc.Propagator, targets: pc.Targets, limits: pc.Limits,
        budget: pc.Budget, out: pc.Gains,
    ) -> pc.Result:  # fmt: skip
        """Return the first result; if it misses `error`, try the dense solver and return the better one."""
        missed = targets.relative_error(propagator.apply(out))
        if missed <= self.error:
            return _label_result(first, self._several, "several points")
        kept = out.copy()
        out[:] = 0.0
        second = self._dense.solve(propagator, targets, limits, None, budget, out)
        if targets.relative_error(propagator.apply(out)) < missed:
            return _label_result(second, self._dense, "many points close together")
        out[:] = kept
        return _label_result(
            first._replace(late=second.late), self._several, "many points close together"
        )

    def _suffices(
        self, propagator: pc.Propagator, targets: pc.Targets, limits: pc.Limits, out: pc.Gains
    ) -> bool:
        """Return whether gains, (N,), keep their limit, and are optimal (all phases given) or meet `error`."""
        top = limits.top_gain
        if not kernels.peak(out) <= top * top:
            return False
        return not targets.free.any() or targets.relative_error(propagator.apply(out)) <= self.error


def _label_result(result: pc.Result, solver: pc.Solver, why: str) -> pc.Result:
    note = f"{why}; {result.note}" if result.note else why
    return result._replace(solver=solver.name, note=note)


@pc.hookimpl
def register_solvers() -> Iterable[type[pc.Solver]]:
    """Return this plug-in's solver."""
    return [Auto]
