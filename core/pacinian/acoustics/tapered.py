"""Tapered capsules, (C, 8): the ends of an axis and the radius at either [m], the hull of the spheres there."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numba
import numpy as np

from pacinian.acoustics.compiled import compiled

if TYPE_CHECKING:
    from pacinian.types import Floats

CAPSULES = numba.types.Array(numba.float64, 2, "C", readonly=True)
SIX = numba.types.Tuple([numba.float64] * 6)  # type: ignore[no-untyped-call]


@compiled(SIX(CAPSULES, numba.int64, numba.float64, numba.float64, numba.float64))
def from_axis(
    capsules: Floats, c: int, x: float, y: float, z: float
) -> tuple[float, float, float, float, float, float]:
    """The way to a point from the middle of the sphere of a capsule that it is nearest to or deepest in.

    Returns also how long that way is and the radius there [m], and where on the axis it is, 0..1. With h along the axis
    u and rho across it, that is s = h + m rho / sqrt(1 - m^2), m being the slope of the radius: there |p - s u| - r(s)
    is least.
    """
    ux, uy, uz = (
        capsules[c, 3] - capsules[c, 0],
        capsules[c, 4] - capsules[c, 1],
        capsules[c, 5] - capsules[c, 2],
    )
    dx, dy, dz = x - capsules[c, 0], y - capsules[c, 1], z - capsules[c, 2]
    radius, grows = capsules[c, 6], capsules[c, 7] - capsules[c, 6]
    square = ux * ux + uy * uy + uz * uz
    if square <= grows * grows:  # one sphere holds the other
        t = 1.0 if grows > 0.0 else 0.0
    else:
        t = (dx * ux + dy * uy + dz * uz) / square
        if grows != 0.0:
            vx, vy, vz = dx - t * ux, dy - t * uy, dz - t * uz
            across = np.sqrt(vx * vx + vy * vy + vz * vz)
            t += grows * across / np.sqrt(square * (square - grows * grows))
        t = min(max(t, 0.0), 1.0)
    dx, dy, dz = dx - t * ux, dy - t * uy, dz - t * uz
    return dx, dy, dz, np.sqrt(dx * dx + dy * dy + dz * dz), radius + t * grows, t
