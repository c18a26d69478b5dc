"""Sets of points at which to ask for pressure, or to evaluate a field: a grid, a disc and a ball."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from pacinian.acoustics.pose import vector
from pacinian.argument_checks import MAX_SAMPLES, check_count, check_length, check_number
from pacinian.errors import ArgumentError
from pacinian.scene.shapes import Disc
from pacinian.scene.shapes.local_samples import EDGE

if TYPE_CHECKING:
    from pacinian.types import ArrayLike, Floats

MIN_POINT_SPACING = 1e-6  # smallest distance of points [m]
ORIGIN = (0.0, 0.0, 0.0)


def grid(size: ArrayLike, spacing: float, centre: ArrayLike = ORIGIN) -> Floats:
    """Return the points of a regular grid, both ends included, (M, 3) [m].

    size: extent in x, y and z, (3,) [m], or in x and y, (2,) [m], for a plane; 0 for one point along an axis. spacing:
    largest distance of neighbours [m]; along each axis, the points are equally spaced. centre: of the grid, (3,) [m].
    x varies fastest, then y, then z: with K = ceil(extent / spacing) + 1 points along each axis, `.reshape(Kz, Ky, Kx,
    3)` gives the grid. To turn it, use `Pose.points`. Raises ArgumentError, also for more than 20 million points.
    """
    spacing, middle = _check_spacing(spacing), vector("centre", centre)
    try:
        given = np.asarray(size, dtype=np.float64)
    except (TypeError, ValueError):
        given = np.empty(0)
    if given.shape not in ((2,), (3,)):
        raise ArgumentError("size", f"must be 2 or 3 extents [m], not {size!r}")
    extents = [check_number("size", extent, low=0.0) for extent in given.tolist()]
    for extent in extents:
        if extent:
            check_length("size", extent)
    counts = [math.ceil(extent / spacing - EDGE) + 1 for extent in extents]
    if math.prod(counts) > MAX_SAMPLES:
        raise ArgumentError(
            "spacing", f"of {spacing:g} m makes {math.prod(counts):g} points: choose a larger one"
        )
    axes = [
        np.linspace(-e / 2.0, e / 2.0, K) if K > 1 else np.zeros(1)
        for e, K in zip(extents, counts, strict=True)
    ]
    axes += [np.zeros(1)] * (3 - len(axes))
    x, y, z = axes
    Z, Y, X = np.meshgrid(z, y, x, indexing="ij")
    return np.stack([X.ravel(), Y.ravel(), Z.ravel()], axis=1) + middle


def disc(radius: float, spacing: float, centre: ArrayLike = ORIGIN) -> Floats:
    """Return points on rings that cover a disc parallel to the xy-plane, (M, 3) [m]; the middle and the rim included.

    radius: of the disc [m]. spacing: largest distance of neighbours on a ring, and of rings [m]. centre: (3,) [m]. To
    turn it, use `Pose.points`. Raises ArgumentError, also for more than 20 million points.
    """
    spacing, middle = _check_spacing(spacing), vector("centre", centre)
    radius = check_length("radius", radius)
    points = Disc(radius).sample_surface(min(spacing, 2.0 * radius)).points
    return np.asarray(points + middle, np.float64)


def ball(radius: float, spacing: float, centre: ArrayLike = ORIGIN) -> Floats:
    """Return the points of a cubic grid that lie in a ball, (M, 3) [m]; one of them is its centre.

    radius: of the ball [m]. spacing: distance of neighbours [m]. centre: (3,) [m]. x varies fastest, then y, then z.
    Raises ArgumentError, also for more than 20 million points.
    """
    spacing, middle = _check_spacing(spacing), vector("centre", centre)
    radius = check_length("radius", radius)
    K = math.floor(radius / spacing + EDGE)
    check_count((2.0 * radius + spacing) ** 3, spacing, 3)
    x = spacing * np.arange(-K, K + 1)
    Z, Y, X = np.meshgrid(x, x, x, indexing="ij")
    points = np.stack([X.ravel(), Y.ravel(), Z.ravel()], axis=1)
    within = (points * points).sum(axis=1) <= (radius * (1.0 + EDGE)) ** 2
    return np.asarray(points[within] + middle, np.float64)


def _check_spacing(spacing: float) -> float:
    return check_number("spacing", check_length("spacing", spacing), low=MIN_POINT_SPACING)
