"""The problems that `check_solver` asks."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np

from pacinian.acoustics.propagation import matrix
from pacinian.solving.problem import Limits, Targets
from pacinian.solving.regions import joint_phases

if TYPE_CHECKING:
    from pacinian.acoustics.array import Array
    from pacinian.types import Floats, Longs


@dataclass(frozen=True, eq=False)
class Problem:
    """Points q (M, 3) [m], amplitudes t (M,) [Pa], phases [rad] or None, limits, regions (M,) or None."""

    q: Floats
    t: Floats
    phases: Floats | None = None
    limits: Limits = field(default_factory=Limits)
    regions: Longs | None = None

    @property
    def targets(self) -> Targets:
        """As a solver is given them."""
        return Targets.checked(len(self.q), self.t, self.phases, "exact", self.regions)


def ordinary(array: Array, count: int, level: float, seed: int = 0, fixed: bool = False) -> Problem:
    """Points above the array, with phases that are `fixed` or free.

    level: of what one focus could reach, shared by the points.
    """
    rng = np.random.default_rng(seed)
    q = array.centre + np.c_[rng.uniform(-0.05, 0.05, (count, 2)), rng.uniform(0.12, 0.2, count)]
    t = rng.uniform(0.5, 1.0, count)
    t *= level * float(np.abs(matrix(array, q)).sum(axis=1).mean()) / float(np.linalg.norm(t))
    return Problem(q, t, rng.uniform(-3.0, 3.0, count) if fixed else None)


def region(array: Array, level: float, apart: float = 0.4) -> Problem:
    """A square of 4 x 4 points, `apart` wavelengths apart, above the array, with the phases of one wave.

    level: of what one focus could reach.
    """
    x = apart * 340.0 / array.transducer.frequency * np.arange(-1.5, 2.0)
    X, Y = np.meshgrid(x, x)
    q = array.centre + np.c_[X.ravel(), Y.ravel(), np.full(16, 0.15)]
    t = np.full(16, level * float(np.abs(matrix(array, q)).sum(axis=1).mean()) / 4.0)
    return Problem(q, t, joint_phases(array, q), regions=np.zeros(16, np.int64))


def named(array: Array) -> list[tuple[str, Problem]]:
    """Ordinary ones, of which there are 12, then awkward ones, and regions; with what is to be said of each."""
    made = [
        (f"{count} points at level {level:g}", ordinary(array, count, level, fixed=fixed))
        for count, level in ((1, 0.5), (1, 3.0), (4, 0.1), (16, 0.8), (16, 1e3), (150, 0.5))
        for fixed in (False, True)
    ]
    four = ordinary(array, 4, 0.3)
    made.append(("coincident points", replace(four, q=four.q[[0, 0, 1, 1]])))
    made.append(("a point of pressure 0", replace(four, t=four.t * [0.0, 1.0, 1.0, 1.0])))
    made.append(("a tiny target", replace(four, t=four.t * 1e-25)))
    below = four.q.copy()
    below[:, 2] = 2.0 * array.centre[2] - below[:, 2]
    made.append(("points behind the array", replace(four, q=below)))
    made += [(f"a region at level {level:g}", region(array, level)) for level in (0.1, 3.0)]
    made.append(("a region in one place", region(array, 0.1, apart=0.0)))
    return made
