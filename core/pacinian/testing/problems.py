"""Test problems for `check_solver`."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np

from pacinian.acoustics.air import Air
from pacinian.acoustics.propagation import matrix
from pacinian.region_numbers import BESIDE
from pacinian.solving.limits import Limits
from pacinian.solving.region_phases import joint_phases
from pacinian.solving.targets import Targets
from pacinian.testing.shapes import (
    HEIGHT,
    Shape,
    make_finger,
    make_line,
    make_ring,
    make_square,
    of,
)

if TYPE_CHECKING:
    from pacinian.acoustics.array import Array
    from pacinian.types import Floats, Longs

REGION_HEIGHT = 0.15  # height of regions above the array [m]


@dataclass(frozen=True, eq=False)
class ConformanceProblem:
    """A problem: points q (M, 3) [m], amplitudes t (M,) [Pa], phases [rad] or None, limits, regions (M,) or None."""

    q: Floats
    t: Floats
    phases: Floats | None = None
    limits: Limits = field(default_factory=Limits)
    regions: Longs | None = None

    @property
    def targets(self) -> Targets:
        """The targets, as a solver receives them."""
        return Targets.make_checked(len(self.q), self.t, self.phases, "exact", self.regions)


def make_random_points(
    array: Array, count: int, level: float, seed: int = 0, fixed: bool = False
) -> ConformanceProblem:
    """Make a problem of random points above the array, with phases that are `fixed` or free.

    level: root of the sum of the squared amplitudes, relative to the pressure of a single focus at full drive.
    """
    rng = np.random.default_rng(seed)
    q = array.centre + np.c_[rng.uniform(-0.05, 0.05, (count, 2)), rng.uniform(0.12, 0.2, count)]
    t = _scale(rng.uniform(0.5, 1.0, count), array, q, level)
    return ConformanceProblem(q, t, rng.uniform(-3.0, 3.0, count) if fixed else None)


def _scale(t: Floats, array: Array, q: Floats, level: float) -> Floats:
    """Return amplitudes at points q whose norm is `level`, relative to the pressure of a single focus at full drive."""
    focus = float(np.abs(matrix(array, q, Air())).sum(axis=1).mean())
    return t * (level * focus / float(np.linalg.norm(t)))


def make_region(array: Array, shape: Shape, level: float = 0.1) -> ConformanceProblem:
    """Make a problem of a shape above the array. Each region has the phases of one wave, as solvers receive them.

    level: norm of the amplitudes, relative to the pressure of a single focus at full drive. Targets beside are 0.
    """
    q = shape.points + array.centre + [0.0, 0.0, REGION_HEIGHT - HEIGHT]
    t = _scale(np.where(shape.regions == BESIDE, 0.0, 1.0), array, q, level)
    phases = np.zeros(len(q))
    for number in range(int(shape.regions.max()) + 1):
        own = shape.regions == number
        phases[own] = joint_phases(array, q[own], Air(), radiation_pressure=t[own] ** 2)
    return ConformanceProblem(q, t, phases, regions=shape.regions)


def make_regions(array: Array) -> list[tuple[str, ConformanceProblem]]:
    """Make one problem for each kind of region, and one that is too strong."""
    disc, four, right = make_ring(0.0, 0.006), make_square(4), np.array([1.0, 0.0, 0.0])
    around = make_ring(0.012, 0.016)
    shapes = {
        "a square": of(four),
        "a line": of(make_line(9)),
        "half of a cylinder": of(make_finger()),
        "a disc in a ring": of(make_ring(0.0, 0.004), make_ring(0.009, 0.012)),
        "two that touch": of(four - 0.006 * right, four + 0.006 * right),
        "two in the same place": of(disc, disc),
        "with points beside": Shape(
            np.concatenate([disc, around]), np.repeat([0, BESIDE], [len(disc), len(around)])
        ),
        "one sample": of(disc[:1]),
        "two samples": of(make_line(2)),
        "all in one place": of(np.repeat(disc[:1], 16, axis=0)),
        "1000 samples": of(make_square(32, spacing=0.00125)[:1000]),
    }
    made = [(f"a region: {what}", make_region(array, shape)) for what, shape in shapes.items()]
    return [*made, ("a region: too strong", make_region(array, of(four), 3.0))]


def make_problems(array: Array) -> list[tuple[str, ConformanceProblem]]:
    """Make 12 problems of random points, then special cases, then regions, each with a name."""
    made = [
        (f"{count} points at level {level:g}", make_random_points(array, count, level, fixed=fixed))
        for count, level in ((1, 0.5), (1, 3.0), (4, 0.1), (16, 0.8), (16, 1e3), (150, 0.5))
        for fixed in (False, True)
    ]
    four = make_random_points(array, 4, 0.3)
    made.append(("coincident points", replace(four, q=four.q[[0, 0, 1, 1]])))
    made.append(("a point of pressure 0", replace(four, t=four.t * [0.0, 1.0, 1.0, 1.0])))
    made.append(("a tiny target", replace(four, t=four.t * 1e-25)))
    below = four.q.copy()
    below[:, 2] = 2.0 * array.centre[2] - below[:, 2]
    made.append(("points behind the array", replace(four, q=below)))
    return made + make_regions(array)
