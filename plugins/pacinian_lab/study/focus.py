"""How large a focus is: its widths along the way of the sound and across it, and its main lobe in a plane."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from scipy.spatial import cKDTree

import pacinian as pc

if TYPE_CHECKING:
    from pacinian.types import Complexes, Flags, Floats

STEPS = 40  # of a profile, a wavelength
FIRST, LAST = 4.0, 128.0  # wavelengths looked at on each side
SPREAD = 0.1  # of the mean direction of the sound; below, it has none


class Widths(NamedTuple):
    """Full widths at half of the largest radiation pressure [m]; infinite where it does not fall so far.

    along: in the mean direction of the sound that arrives at the focus, weighted with |B|^2, or in z where it comes
    from all sides. across_x: square to that, and to y. across_y: square to both.
    """

    along: float
    across_x: float
    across_y: float


def widths(array: pc.Array, point: Floats, medium: pc.Air) -> Widths:
    """Of the focus at a point (3,) [m], all transducers at full drive and in phase there.

    The profile P(s) ~ |p|^2 is followed from the focus up to its nearest maximum, and from there down on both sides
    until it is half of that; half a wavelength from a transducer it ends. Raises PointOnTransducer.
    """
    B = pc.matrix(array, point[None], medium)[0]
    size = np.abs(B)
    gains = np.where(size > 0.0, B.conj() / np.maximum(size, 1e-300), 0.0)
    return Widths(*(_width(array, gains, point, way, medium) for way in ways(array, point, size)))


def ways(array: pc.Array, point: Floats, size: Floats) -> Floats:
    """The directions of the three widths, (3, 3), each square to the others; size: |B|, (N,)."""
    d = point - array.positions
    d = d / np.maximum(np.sqrt((d * d).sum(axis=1)), 1e-30)[:, None]
    w = size**2 / max(float((size**2).sum()), 1e-300)
    along = w @ d
    length = float(np.sqrt(along @ along))
    along = along / length if length > SPREAD else np.array([0.0, 0.0, 1.0])
    x = np.cross([0.0, 1.0, 0.0], along)
    if x @ x < SPREAD**2:  # the sound goes along y
        x = np.array([1.0, 0.0, 0.0]) - along[0] * along
    x /= np.sqrt(x @ x)
    return np.stack([along, x, np.cross(along, x)])


def _width(array: pc.Array, gains: Complexes, point: Floats, way: Floats, medium: pc.Air) -> float:
    wavelength = medium.wavelength(array.transducer.frequency)
    tree = cKDTree(array.positions)
    reach = FIRST
    while reach <= LAST:
        count = round(reach * STEPS)
        s = np.arange(-count, count + 1, dtype=np.float64) * (wavelength / STEPS)  # [m]
        points = point + s[:, None] * way
        near = np.asarray(tree.query(points)[0] < wavelength / 2.0)
        below, above = _ends(near, count)
        part = slice(below, above)
        P = np.abs(pc.field(array, gains, points[part], medium)).astype(np.float64) ** 2
        found = full_width(s[part], P, count - below)
        if math.isfinite(found):
            return found
        if near[:count].any() and near[count:].any():
            break
        reach *= 2.0
    return math.inf


def _ends(near: Flags, middle: int) -> tuple[int, int]:
    """The part about the middle in which no point is near a transducer."""
    before, after = np.flatnonzero(near[:middle]), np.flatnonzero(near[middle + 1 :])
    below = int(before[-1]) + 1 if len(before) else 0
    return below, middle + 1 + int(after[0]) if len(after) else len(near)


def full_width(s: Floats, P: Floats, start: int) -> float:
    """How far apart P(s) is half of its maximum nearest uphill from `start`; infinite where it is not.

    s: ascending, (K,). P: (K,).
    """
    top = start
    while 0 < top < len(P) - 1 and max(P[top - 1], P[top + 1]) > P[top]:
        top += 1 if P[top + 1] >= P[top - 1] else -1
    half = P[top] / 2.0
    lower = np.flatnonzero(P[:top] < half)
    upper = np.flatnonzero(P[top:] < half)
    if not (len(lower) and len(upper)):
        return math.inf
    i, j = int(lower[-1]), top + int(upper[0])
    left = np.interp(half, P[i : i + 2], s[i : i + 2])
    right = np.interp(-half, -P[j - 1 : j + 1], s[j - 1 : j + 1])
    return float(right - left)


def lobes(array: pc.Array, points: Floats, axes: Floats, medium: pc.Air) -> Floats:
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
    """Which pixels (..., 2) [m] are in the main lobe of a point, uv (M, 2) [m], of its shape S, (M, 2, 2)."""
    inside = np.zeros(pixels.shape[:-1], dtype=np.bool_)
    for centre, S in zip(uv, shapes, strict=True):
        u, v = pixels[..., 0] - centre[0], pixels[..., 1] - centre[1]
        inside |= S[0, 0] * u * u + 2.0 * S[0, 1] * u * v + S[1, 1] * v * v < 1.0
    return inside
