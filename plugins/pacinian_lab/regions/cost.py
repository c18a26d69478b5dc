"""Measure the cost of a region: a cold solve, a warm one, and B alone."""

from __future__ import annotations

import time
from functools import partial
from statistics import median
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from pacinian.acoustics.array import autd
from pacinian.session import Session
from pacinian_lab.regions.shapes import HEIGHT
from pacinian_lab.solvers.problems import AIR

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from pacinian.types import Floats

SIDES = (1, 3)  # AUTD units along each side: 249 and 2241 transducers
GRIDS = {60: (10, 6), 120: (12, 10), 250: (25, 10)}  # samples along x and y
SPACING = 0.003  # [m] between samples
STRENGTH = 0.5  # fraction of the strongest even field
MOVE = np.array([0.0004, 0.0, 0.0])  # [m] between warm solves
TIMES = 9  # repeats of each measurement


class Cost(NamedTuple):
    """The cost of one region, medians [ms].

    saturation: fraction of the transducers at their limit. cold_ms: a solve without earlier state. warm_ms: a solve
    after all samples have moved by 0.4 mm. corrected_ms: a cold solve with its corrections, which the first two do
    without. build_ms: B of moved samples alone, which all others include. cold_steps, warm_steps: Newton steps.
    """

    transducers: int
    samples: int
    saturation: float
    cold_ms: float
    warm_ms: float
    corrected_ms: float
    build_ms: float
    cold_steps: int
    warm_steps: float


def measure_cost() -> Iterator[Cost]:
    """Measure rectangular regions of 60, 120 and 250 samples on 249 and 2241 transducers, at half strength."""
    for side in SIDES:
        for samples in GRIDS:
            yield measure_one(side, samples)


def measure_one(side: int, samples: int) -> Cost:
    """Measure a region of 60, 120 or 250 samples, 0.2 m above side x side AUTD units."""
    array = autd(side, side)
    q, region = place_grid(*GRIDS[samples]), np.zeros(samples, np.int64)
    session = Session(array, AIR)
    t = np.ones(samples)
    strongest = session.solve(q, t, regions=region, scale="max").sound_pressure
    P = STRENGTH * float(np.vdot(strongest, strongest).real) / samples
    t *= np.sqrt(P)
    session.solve(q, t, regions=region)  # warms up

    cold: dict[int, list[float]] = {session.corrections: [], 0: []}
    for session.corrections, times in cold.items():
        for _ in range(TIMES):
            session.forget()
            times.append(_time(partial(session.solve, q, t, regions=region)))
    assert session.last is not None
    first = session.last
    corrected, plain = cold.values()

    warm, steps, built = list[float](), list[int](), list[float]()
    for n in range(1, TIMES + 1):
        at = q + n * MOVE
        warm.append(_time(partial(session.solve, at, t, regions=region)))
        steps.append(session.last.iterations)
    for n in range(TIMES):
        built.append(_time(partial(session.propagator.set_points, q + n * MOVE)))
    return Cost(
        len(array), samples, first.saturation,
        median(plain), median(warm), median(corrected), median(built), first.iterations, median(steps),
    )  # fmt: skip


def place_grid(columns: int, rows: int) -> Floats:
    """Lay samples on a grid, (columns * rows, 3) [m], centred 0.2 m above the array."""
    x, y = (SPACING * (np.arange(n) - (n - 1) / 2.0) for n in (columns, rows))
    X, Y = np.meshgrid(x, y)
    return np.asarray(
        np.stack([X.ravel(), Y.ravel(), np.full(X.size, HEIGHT)], axis=-1), np.float64
    )


def _time(work: Callable[[], object]) -> float:
    """Return the run time [ms]."""
    begin = time.perf_counter()
    work()
    return 1e3 * (time.perf_counter() - begin)
