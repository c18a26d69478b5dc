"""Gerchberg-Saxton between points and transducers, plain (`gs`) and weighted (`weighted-gs`)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated, ClassVar

from msgspec import Meta

import pacinian as pc
from pacinian.argument_checks import check_integer, check_kind, check_number
from pacinian_plugins.solvers.gs.alternation import MIN_ABS, Alternation


@dataclass(frozen=True)
class Gs(pc.Solver):
    """Gerchberg-Saxton, "iterative back-propagation" (Marzo & Drinkwater, PNAS 116(1), 2019).

    steps: number of steps. amplitudes: whether transducers may be driven below the limit.

    Each step propagates the targets back to the transducers and forward again: g = P(B^H D^-1 y) and
    y_m = t_m exp(j arg (B g)_m), where D is the diagonal of B B^H. P keeps only the phase (amplitudes=False: all
    transducers have the same drive), or clips gains to the limit after B g is scaled to the strength of t. The
    phases are chosen well, but nothing corrects the amplitudes: they are off by some percent, or by tens of
    percent for many points. Fixed phases are kept as targets and met equally roughly. Points with amplitude 0 get
    no sound, but are not silenced.
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
        alternation = Alternation(propagator, targets, limits, warm, budget, out)
        return alternation.run(self.steps, floor)


@dataclass(frozen=True)
class WeightedGs(pc.Solver):
    """Weighted Gerchberg-Saxton (Di Leonardo, Ianni & Ruocco, Optics Express 15(4), 2007).

    steps: maximum number of steps. exponent: of the correction of the weights; 1, as published, oscillates between
    two states for some pairs of points; 1/2 does not. hold: number of steps after which the phases at the points
    are fixed (Kim et al., Optics Letters 44(12), 2019); this converges in a fifth of the steps.

    Like `gs` with amplitudes=False, but with weighted targets y_m = w_m t_m exp(j arg p_m), where
    w_m <- w_m (mean(|p| / t) / (|p_m| / t_m))^exponent. It ends when the amplitudes are right within 0.01 %, or after
    `steps`. Fixed phases and amplitudes of 0 are treated as in `gs`.
    """

    name: ClassVar[str] = "weighted-gs"
    linear: ClassVar[bool] = True
    max_uniform_points: ClassVar[float] = math.inf

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
        alternation = Alternation(propagator, targets, limits, warm, budget, out)
        return alternation.run(self.steps, MIN_ABS, self.exponent, self.hold)
