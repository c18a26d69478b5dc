"""Gerchberg-Saxton between points and transducers: plain (`gs`) and weighted (`weighted-gs`)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, ClassVar

from msgspec import Meta

import pacinian as pc
from pacinian.checks import check_integer, check_kind, check_number
from pacinian_plugins.solvers.gs.alternation import MIN_ABS, Run

if TYPE_CHECKING:
    from collections.abc import Iterable


@dataclass(frozen=True)
class Gs(pc.Solver):
    """Gerchberg-Saxton, "iterative back-propagation" (Marzo & Drinkwater, PNAS 116(1), 2019).

    steps: how many. amplitudes: whether transducers may be driven below the limit.

    Targets go back to the transducers and forth again: g = P(B^H D^-1 y), y_m = t_m exp(j arg (B g)_m),
    D the diagonal of B B^H. P keeps the phase only (amplitudes=False: all driven alike), or cuts gains
    to the limit, B g brought to the strength of t each time. It chooses phases well but nothing
    corrects the amplitudes: they come out some percent wrong, tens of percent for many points. Fixed phases are
    kept as targets and met as roughly; an amplitude of 0 is not sent to, and not silenced.
    """

    name: ClassVar[str] = "gs"
    linear: ClassVar[bool] = True

    steps: Annotated[int, Meta(ge=1, le=1000)] = 100
    amplitudes: bool = True

    def __post_init__(self) -> None:
        object.__setattr__(self, "steps", check_integer("steps", self.steps, low=1))
        check_kind("amplitudes", self.amplitudes, bool)

    def solve(
        self,
        propagator: pc.Propagator,
        targets: pc.Targets,
        limits: pc.Limits,
        warm: pc.Solution | None,
        budget: pc.Budget,
        out: pc.Gains,
    ) -> pc.Result:
        """Write the gains; see `pacinian.Solver.solve`."""
        floor = 1.0 if self.amplitudes else MIN_ABS
        return Run(propagator, targets, limits, warm, budget, out).go(self.steps, floor)


@dataclass(frozen=True)
class WeightedGs(pc.Solver):
    """Weighted Gerchberg-Saxton (Di Leonardo, Ianni & Ruocco, Optics Express 15(4), 2007).

    steps: at most so many. exponent: of the weights' correction; 1 as published swings between two
    states for some pairs of points, 1/2 does not. hold: steps after which the phases at the points
    stay (Kim et al., Optics Letters 44(12), 2019), which converges in a fifth of the steps.

    As `gs` with phases only, all transducers driven alike, from weighted targets y_m = w_m t_m exp(j arg p_m)
    with w_m <- w_m (mean of |p|/t : |p_m|/t_m)^exponent, until amplitudes are right within 0.01 % or stay wrong.
    Fixed phases and amplitudes of 0 as in `gs`.
    """

    name: ClassVar[str] = "weighted-gs"
    linear: ClassVar[bool] = True
    even: ClassVar[float] = math.inf

    steps: Annotated[int, Meta(ge=1, le=1000)] = 100
    exponent: Annotated[float, Meta(ge=0.0, le=1.0)] = 0.5
    hold: Annotated[int, Meta(ge=1, le=1000)] = 20

    def __post_init__(self) -> None:
        object.__setattr__(self, "steps", check_integer("steps", self.steps, low=1))
        object.__setattr__(
            self, "exponent", check_number("exponent", self.exponent, low=0.0, high=1.0)
        )
        object.__setattr__(self, "hold", check_integer("hold", self.hold, low=1))

    def solve(
        self,
        propagator: pc.Propagator,
        targets: pc.Targets,
        limits: pc.Limits,
        warm: pc.Solution | None,
        budget: pc.Budget,
        out: pc.Gains,
    ) -> pc.Result:
        """Write the gains; see `pacinian.Solver.solve`."""
        run = Run(propagator, targets, limits, warm, budget, out)
        return run.go(self.steps, MIN_ABS, self.exponent, self.hold)


@pc.hookimpl
def register_solvers() -> Iterable[type[pc.Solver]]:
    """This plug-in's solvers."""
    return [Gs, WeightedGs]
