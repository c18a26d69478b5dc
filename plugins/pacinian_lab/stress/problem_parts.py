"""Building blocks of the problem families."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from pacinian.acoustics.air import Air
from pacinian.acoustics.array import lattice
from pacinian.acoustics.propagation import matrix
from pacinian.solving.limits import Limits
from pacinian.testing import shapes

if TYPE_CHECKING:
    from pacinian.acoustics.array import Array
    from pacinian.types import ArrayLike, Floats

SMALL_ARRAY = lattice(0.05, 0.05)  # 36 ideal transducers
HEIGHT = shapes.HEIGHT  # [m]
PHASES: dict[str, ArrayLike | None] = {"free": None, "fixed": 0.0}
NO_LIMIT = Limits(gain=None)


def scatter_points(
    count: int, seed: int = 0, width: float = 0.06, height: float = HEIGHT
) -> Floats:
    """Return random points [m], (count, 3), above the small array."""
    rng = np.random.default_rng(seed)
    x, y = rng.uniform(-width / 2, width / 2, (count, 2)).T
    return np.stack([x, y, np.full(count, height)], axis=1)


def compute_asked(
    array: Array, points: Floats, level: float, shares: ArrayLike = 1.0, medium: Air | None = None
) -> Floats:
    """Return amplitudes [Pa], (M,), in proportion to `shares`, with a 2-norm of `level` times a focus's reach.

    medium: the air; default `Air()`.
    """
    if not len(points):
        return np.zeros(0)
    t = np.broadcast_to(np.asarray(shares, dtype=np.float64), (len(points),))
    reach = np.abs(matrix(array, points, medium or Air())).sum(axis=1).mean()
    return np.asarray(t / np.linalg.norm(t) * level * reach)


def half(count: int) -> Floats:
    """Return phases of which every second is free, (count,)."""
    return np.where(np.arange(count) % 2, np.nan, np.arange(count))


def row(condition: float) -> Floats:
    """Return five points [m], (5, 3), in a row, spaced so that B has the condition number `condition`."""

    def points(spacing: float) -> Floats:
        x = np.arange(-2, 3) * spacing
        return np.stack([x, np.full(5, 0.003), np.full(5, HEIGHT)], axis=1)

    low, high = 1e-7, 0.012  # [m]
    for _ in range(40):
        middle = float(np.sqrt(low * high))
        s = np.linalg.svd(matrix(SMALL_ARRAY, points(middle), Air()), compute_uv=False)
        low, high = (middle, high) if s[0] > condition * s[-1] else (low, middle)
    return points(high)
