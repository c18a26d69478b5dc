"""The main lobes of foci in a plane, from the directions under which an array's transducers are seen."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

import pacinian as pc

if TYPE_CHECKING:
    from pacinian.types import Flags, Floats


def shapes(array: pc.Array, points: Floats, axes: Floats, medium: pc.Air) -> Floats:
    """For each point the matrix S, (M, 2, 2) [1/m^2]: the main lobe of its focus is d^T S d < 1, d in the plane.

    Near a focus the pressure is 1 - k^2 d^T C d / 2 of its largest, C being the covariance of the unit vectors
    to the transducers, weighted with |B|^2 (`pacinian.resolution`). Directions that spread evenly with the
    variance sigma^2 make the first null at lambda / (2 sqrt(3) sigma), so that S = 12 C / lambda^2 in the plane.

    points: (M, 3) [m]. axes: of the plane, (2, 3).
    """
    wavelength = medium.wavelength(array.transducer.frequency)
    S = np.empty((len(points), 2, 2))
    for m, q in enumerate(points):
        w = np.abs(pc.matrix(array, q[None], medium)[0]) ** 2
        d = array.positions - q
        u = (d / np.maximum(np.sqrt((d * d).sum(axis=1)), 1e-30)[:, None]) @ axes.T
        w /= max(float(w.sum()), 1e-300)
        u -= w @ u
        S[m] = 12.0 / wavelength**2 * (u.T * w) @ u
    return S


def within(pixels: Floats, uv: Floats, shapes: Floats) -> Flags:
    """Which pixels (..., 2) [m] are in the main lobe of a point, uv (M, 2) [m], of its shape, (M, 2, 2)."""
    inside = np.zeros(pixels.shape[:-1], dtype=np.bool_)
    for centre, S in zip(uv, shapes, strict=True):
        u, v = pixels[..., 0] - centre[0], pixels[..., 1] - centre[1]
        inside |= S[0, 0] * u * u + 2.0 * S[0, 1] * u * v + S[1, 1] * v * v < 1.0
    return inside
