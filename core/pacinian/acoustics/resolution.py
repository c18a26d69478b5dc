"""How finely an array resolves, and how wide its focus is, by the directions from which the sound comes.

Near a focus at q, with each transducer's sound in phase and weighted w_n there, the field is

    |p(q + d)| / |p(q)| = 1 - k^2 d^T C d / 2

where C is the covariance of the unit vectors from q to the transducers, weighted with w_n.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from pacinian.acoustics.air import Air
from pacinian.acoustics.propagation import KernelData
from pacinian.checks import check_numbers
from pacinian.errors import ArgumentError

if TYPE_CHECKING:
    from pacinian.acoustics.array import Array
    from pacinian.types import ArrayLike, Floats

MAIN_LOBE = 0.86  # of pi / (k^2 sqrt(det C)): 0.853 of a rectangle, 0.838 of a disc, more where w falls to the rim
MIN_LENGTH = 1e-30  # of a vector that is divided by its length


def resolution(array: Array, points: ArrayLike, medium: Air | None = None) -> Floats:
    """How far from a focus its main lobe ends, in the direction in which that is nearest [m], (M,).

    With w = |B|^2. Directions that spread evenly with the variance sigma^2, C's largest, make the first null at
    lambda / (2 sqrt(3) sigma). Infinite where a single transducer is heard, or none.

    array: N transducers. points: [m], (M, 3). medium: `Air()` unless given. Raises ArgumentError; PointOnTransducer.
    """
    medium = medium or Air()
    q = check_numbers("points", points, (None, 3))
    _, C = _spread(array, q, np.zeros_like(q), medium)
    sigma = np.sqrt(np.maximum(np.linalg.eigvalsh(C)[:, -1], 0.0))
    wavelength = medium.wavelength(array.transducer.frequency)
    with np.errstate(divide="ignore"):
        return np.asarray(wavelength / (2.0 * math.sqrt(3.0) * np.where(sigma > 1e-6, sigma, 0.0)))


def focal_area(
    array: Array,
    points: ArrayLike,
    normals: ArrayLike | None = None,
    medium: Air | None = None,
    *,
    even: bool = False,
) -> Floats:
    """Force of a focus over the radiation pressure at its centre [m^2], (M,).

    The force is the integral of the radiation pressure over the main lobe, out to where it first stops falling, on a
    plane through the focus. Its area is 0.86 pi / (k^2 sqrt(det C)), with C in that plane: within 7 % of the integral
    for flat filled, sparse and random arrays, 0.08 to 0.4 m away, 15 % for one folded by 30 degrees; a ring may be off
    by far more (docs/concepts.md). Infinite where there is no focus: a
    single transducer is heard, or none, or all of them in one line.

    array: N transducers. points: [m], (M, 3). normals: of the skin, outward, (M, 3); zero, or not given, for a plane
    across the way on which the sound comes. Where there is a normal, sound counts with the cosine of its incidence
    (`SkinFacing`). medium: `Air()` unless given. even: whether all transducers are driven alike, as by `single-focus`
    (w = |B|); else in proportion to how well each is heard, which takes the least power (w = |B|^2), as by `lagrange`.
    Raises ArgumentError; PointOnTransducer.
    """
    medium = medium or Air()
    q = check_numbers("points", points, (None, 3))
    n = np.zeros_like(q) if normals is None else check_numbers("normals", normals, (None, 3))
    if len(n) != len(q):
        raise ArgumentError("normals", f"must be one for each of {len(q)} points, not {len(n)}")
    mean, C = _spread(array, q, n, medium, even=even)
    n = np.where(n.any(axis=1, keepdims=True), n, mean)
    n = n / np.maximum(np.sqrt((n * n).sum(axis=1, keepdims=True)), MIN_LENGTH)
    adjugate = np.cross(C[:, (1, 2, 0)], C[:, (2, 0, 1)])
    det = np.einsum("mi,mij,mj->m", n, adjugate, n)  # of C in the plane
    k = medium.wavenumber(array.transducer.frequency)
    with np.errstate(divide="ignore"):
        return np.asarray(MAIN_LOBE * math.pi / (k * k * np.sqrt(np.where(det > 1e-12, det, 0.0))))


def _spread(
    array: Array, q: Floats, n: Floats, medium: Air, *, even: bool = False
) -> tuple[Floats, Floats]:
    """Mean, (M, 3), and covariance, (M, 3, 3), of the unit vectors from points q, (M, 3), to the transducers."""
    from pacinian.native.acoustics import spread

    B = np.empty((len(q), len(array)), dtype=np.complex64)
    KernelData.prepare(array, medium).matrix(q, B)
    mean, C = np.empty((len(q), 3)), np.empty((len(q), 3, 3))
    spread(np.ascontiguousarray(q), np.ascontiguousarray(n), array.positions, B, even, mean, C)
    return mean, C
