"""The solution for one set of samples, as it is kept while they sound."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from pacinian.acoustics.pressure import radiation_pressure
from pacinian.solving.solution_status import Status

if TYPE_CHECKING:
    from pacinian.rendering.envelope_groups import EnvelopeGroups
    from pacinian.scene.sampling.samples import Samples
    from pacinian.solving.solution import Solution
    from pacinian.types import Floats, Gains

# Pause before each further solve for samples that have been solved for many times without success [s]. A busy processor
# may have spoilt the solves before. MAX_FAILED_IMPROVEMENTS in sample_solver.py and MAX_TRIES in frame_cycle.py say how
# many.
RETRY_INTERVAL = 0.25


@dataclass(frozen=True, eq=False)
class CachedSolution:
    """Gains for a set of samples.

    gains: at full envelope, (N,). groups: the samples' groups by envelope; None if the gains contain the envelopes.
    contributions: of each group, (groups + 1, N), if there is more than one. solution: with its evidence. samples:
    those solved for. steady: whether the gains need no change while the samples stay. final: whether solving again
    would not help, because the solver had enough time. failed_improvements: number of successive solves that were not
    better. averaged: whether envelopes that vary were replaced by their means. all_samples: all of them, including
    those that were left out because no sound can reach them, or because another frame of the cycle renders them.
    weakened, missed: indices into `all_samples`: of the samples that little sound reaches, and of those that get
    clearly less than their target. limited: whether it is scaled down, because the pressure on skin would exceed its
    limit. limited_in_zones: whether it is scaled down, because quiet zones would be too loud after rounding. evaluated:
    whether the pressure on skin was compared with its limit, if there is a limit. retry: time from which to solve again
    if it is not final [s]. awaits_rest: whether to solve without a deadline, which comes nearer to the targets, once
    the samples have been at rest for a while.
    """

    gains: Gains
    groups: EnvelopeGroups | None
    contributions: Gains | None
    solution: Solution
    samples: Samples
    steady: bool
    final: bool
    failed_improvements: int = 0
    averaged: bool = False
    all_samples: Samples | None = None
    weakened: tuple[int, ...] = ()
    missed: tuple[int, ...] = ()
    limited: bool = False
    limited_in_zones: bool = False
    evaluated: bool = True
    retry: float = -math.inf
    awaits_rest: bool = False

    def needs_no_solve(self, t: float) -> bool:
        """Return whether a solve at time t [s] is not needed, or not yet."""
        return self.final or t < self.retry

    def scale(self, factor: float, note: str) -> CachedSolution:
        """Return it with all gains multiplied by a factor, 0..1, and a note that says why."""
        a = np.float32(factor)
        solution = replace(
            self.solution,
            gains=a * self.solution.gains,
            sound_pressure=float(a) * self.solution.sound_pressure,
            status=Status.scaled,
            bound=math.nan,
            objective=math.nan,
            note=note,
        )
        each = None if self.contributions is None else a * self.contributions
        return replace(self, gains=solution.gains, contributions=each, solution=solution)

    @cached_property
    def pressures(self) -> tuple[Floats, Floats]:
        """Radiation pressures asked for and made at `samples`, (M',) [Pa]."""
        medium = self.solution.medium
        asked = radiation_pressure(self.solution.targets.amplitudes, medium)
        return asked, radiation_pressure(self.solution.sound_pressure, medium)

    @property
    def ran_out_of_time(self) -> bool:
        """Whether the solver ran out of time."""
        late = self.solution.late and self.solution.targets.regions is not None
        return late or self.solution.status is Status.deadline

    @property
    def nbytes(self) -> int:
        """Size of its gains [bytes]."""
        return self.gains.nbytes + (0 if self.contributions is None else self.contributions.nbytes)
