"""The result of sampling and solving, which passes from a job to the ticks that play it."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

from pacinian.scene.sampling.sample_counts import label_samples

if TYPE_CHECKING:
    from pacinian.plugins.solver import Solver
    from pacinian.rendering.cached_solution import CachedSolution
    from pacinian.rendering.solved import Solved
    from pacinian.scene.sampling.sample_counts import SampleCounts
    from pacinian.scene.scene import Scene
    from pacinian.types import Floats


class SolveResult(NamedTuple):
    """The result of sampling and solving for a scene.

    solver: that solved. fresh: the solutions that are new. sample_pressures: sound pressure amplitude at the played
    samples, as emitted where they were solved for, (M,) [Pa]; None if it is not known. time: that this was made for
    [s]. seconds: that it took beside the ticks [s]; NaN in a tick.
    """

    scene: Scene
    sample_counts: SampleCounts
    solved: Solved
    solver: Solver
    fresh: tuple[CachedSolution, ...] = ()
    sample_pressures: Floats | None = None
    time: float = 0.0
    seconds: float = math.nan

    @property
    def tells_time(self) -> bool:
        """Whether its duration tells how long solves take: there was one, or silence needed none."""
        return bool(self.fresh) or not len(self.solved.samples)

    @property
    def labels(self) -> set[str]:
        """Labels of all objects that it concerns."""
        return {*self.sample_counts.labels, *label_samples(self.solved.samples)}
