"""Samples in a shape's own frame, and helpers that lay out grids."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from pacinian.argument_checks import check_count

if TYPE_CHECKING:
    from pacinian.acoustics.pose import Vector
    from pacinian.types import Floats

GOLDEN_ANGLE = math.pi * (3.0 - math.sqrt(5.0))  # golden angle [rad]
EDGE = 1e-9  # tolerance for rounding numbers of steps


class LocalSamples(NamedTuple):
    """Samples in a shape's own frame.

    points: (K, 3) [m]. normals: outward, (K, 3). area: represented by each sample, (K,) [m^2]; these sum to the area of
    the shape.
    """

    points: Floats
    normals: Floats
    area: Floats


def sample_grid(extent: Vector, spacing: float) -> Floats:
    """Return a centred grid in the box of half size `extent` [m], (K, 3)."""
    check_count(8.0 * math.prod(extent), spacing, 3)
    axes = [centre(2.0 * half, spacing) for half in extent]
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)


def span(extent: float, spacing: float) -> tuple[Floats, Floats]:
    """Return equally spaced points on a centred interval, both ends included, and the length each represents [m].

    The points are at most `spacing` apart. An interval shorter than `spacing` / 2 gets one point in its middle.
    """
    if extent < spacing / 2.0:
        return np.zeros(1), np.full(1, extent)
    K = math.ceil(extent / spacing - EDGE) + 1
    share = np.full(K, extent / (K - 1))
    share[[0, -1]] /= 2.0
    return np.linspace(-extent / 2.0, extent / 2.0, K), share


def centre(extent: float, spacing: float) -> Floats:
    """Return points at least `spacing` apart, which start half a step from both ends of a centred interval [m]."""
    K = max(1, math.floor(extent / spacing + EDGE))
    return np.linspace(0.5 - K / 2.0, K / 2.0 - 0.5, K) * (extent / K)
