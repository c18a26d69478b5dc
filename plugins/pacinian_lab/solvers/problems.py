"""The problems: random points in a square in front of AUTD-shaped arrays, and the evaluator's own B."""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from pacinian.acoustics.air import Air
from pacinian.acoustics.array import autd
from pacinian.argument_checks import check_integer, check_number
from pacinian.errors import ArgumentError

if TYPE_CHECKING:
    from collections.abc import Iterable

    from pacinian.types import Complexes, Floats

FREQUENCY, SPEED, PRESSURE = 40_000.0, 340.0, 4.386  # [Hz], [m/s], [Pa m]
AIR = Air(speed_of_sound=SPEED, density=1.2)
WAVENUMBER = 2.0 * math.pi * FREQUENCY / SPEED  # [rad/m]
SIDE, DISTANCE = 0.2, 0.2  # [m] of the square: its side, its distance from the array's centre plane
STEP, FRAMES = 1e-3, 6  # [m]; between warm solves, points move around a hexagon of side STEP


class Preset(NamedTuple):
    """Which problems a run solves, all combinations, and for how long.

    units: AUTD units. points: numbers of points. levels: as in `BenchmarkProblem`. seeds: number of problems of each
    kind. seconds: time to measure each solver on each problem [s].
    """

    units: list[int]
    points: list[int]
    levels: list[float]
    seeds: int
    seconds: float


NORMAL = Preset(units=[1, 4, 9], points=[4, 16, 64], levels=[0.5, 1.0], seeds=3, seconds=0.1)
QUICK = Preset(units=[1, 9], points=[4, 16], levels=[0.5, 1.0], seeds=1, seconds=0.02)
LARGE = Preset(units=[9], points=[256, 1024], levels=[0.5, 1.0], seeds=1, seconds=1.0)


def matrix(positions: Floats, points: Floats) -> Complexes:
    """Return B [Pa], (M, N), for omnidirectional transducers, in plain NumPy, without the solvers' kernels."""
    r = np.linalg.norm(points[:, None] - positions, axis=2)
    return np.asarray(PRESSURE / r * np.exp(-1j * WAVENUMBER * r))


@dataclass(frozen=True, eq=False)
class BenchmarkProblem:
    """M points in front of an array.

    units: AUTD units, 1, 4, 9, ... (in a square). level: root of the sum of the squared targets, relative to the
    pressure of a single focus at full drive. seed: of the points and of the proportions. positions: of the transducers
    [m], (N, 3). points: [m], (M, 3). targets: sound pressures [Pa], (M,).
    """

    units: int
    level: float
    seed: int
    positions: Floats
    points: Floats
    targets: Floats

    @classmethod
    def make(cls, units: int, count: int, level: float, seed: int) -> BenchmarkProblem:
        """Return a problem of `count` points, with proportions 0.3..1, at `level`. Raises ArgumentError."""
        side = math.isqrt(check_integer("units", units, low=1))
        if side * side != units:
            raise ArgumentError("units", f"must be a square number (1, 4, 9, ...), not {units}")
        check_number("levels", level, low=0.0, above=True)
        r = autd(side, side).positions
        rng = np.random.default_rng(seed)
        count = check_integer("points", count, low=1)
        q = np.c_[rng.uniform(-SIDE / 2, SIDE / 2, (count, 2)), np.full(count, DISTANCE)]
        t = rng.uniform(0.3, 1.0, count)
        t *= level * np.abs(matrix(r, q)).sum(axis=1).mean() / np.linalg.norm(t)
        return cls(units, level, seed, r, q, t)

    @functools.cached_property
    def frames(self) -> Floats:
        """Positions of the points in consecutive solves [m], (6, M, 3). Each moves by 1 mm per solve, on a hexagon."""
        start = np.random.default_rng(self.seed).uniform(0.0, 2.0 * np.pi, len(self.points))
        angle = start + 2.0 * np.pi / FRAMES * np.arange(FRAMES)[:, None]
        path = STEP * np.stack([np.cos(angle), np.sin(angle), np.zeros_like(angle)], axis=-1)
        return np.asarray(self.points + (path - path[0]))

    def message(self) -> dict[str, Any]:
        """Return the problem as a message for a worker."""
        return make_message(self.positions, self.frames, self.targets)


def make_message(positions: Floats, frames: Floats, targets: Floats) -> dict[str, Any]:
    """Return a problem as a message for a worker. frames: the points in consecutive solves [m], (K, M, 3)."""
    return {
        "positions": positions.tolist(),
        "frames": frames.tolist(),
        "targets": targets.tolist(),
        "wavenumber": WAVENUMBER,
        "pressure": PRESSURE,
    }


def problems(
    units: Iterable[int], points: Iterable[int], levels: Iterable[float], seeds: int
) -> list[BenchmarkProblem]:
    """Return all combinations, the small ones first, with seeds 0..seeds - 1."""
    return [
        BenchmarkProblem.make(u, count, level, seed)
        for u in sorted(set(units))
        for count in sorted(set(points))
        for level in sorted(set(levels))
        for seed in range(seeds)
    ]
