"""Resolution and focal area of an array, from the directions in which the sound arrives.

Near a focus at q, where the sound of all transducers is in phase and has weights w_n, the field is

    |p(q + d)| / |p(q)| = 1 - k^2 d^T C d / 2

where C is the covariance of the unit vectors from q to the transducers, with weights w_n.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from pacinian.acoustics.propagation import KernelData, check_medium
from pacinian.argument_checks import check_numbers
from pacinian.errors import ArgumentError

if TYPE_CHECKING:
    from pacinian.acoustics.air import Air
    from pacinian.acoustics.array import Array
    from pacinian.types import ArrayLike, Floats

# Area of the main lobe, relative to pi / (k^2 sqrt(det C)): 0.853 for a rectangular array, 0.838 for a disc, more if w
# decreases towards the rim.
MAIN_LOBE = 0.86
MIN_LENGTH = 1e-30  # smallest vector length used as a divisor


def resolution(array: Array, points: ArrayLike, medium: Air) -> Floats:
    """Return the distance from a focus to the end of its main lobe, in the direction where it is shortest, (M,) [m].

    The weights are w = |B|^2. Uniformly distributed directions with variance sigma^2, the largest eigenvalue of C, have
    the first null at lambda / (2 sqrt(3) sigma). Infinite if sound arrives from one transducer only, or from none.
    array: N transducers. points: (M, 3) [m]. medium: the air. Raises ArgumentError, PointOnTransducer.
    """
    check_medium(medium)
    q = check_numbers("points", points, (None, 3))
    return find_lobe(array, q, medium)[:, 0]


def find_lobe(array: Array, q: Floats, medium: Air) -> Floats:
    """Return the distances from foci at q, (M, 3) [m], to the end of their main lobe, (M, 2) [m].

    First in the direction where it is shortest, as of `resolution`, then across it: for an elongated array, the main
    lobe is wide along its short side. Raises PointOnTransducer.
    """
    _, C = _spread(array, q, np.zeros_like(q), medium)
    sigma = np.sqrt(np.maximum(np.linalg.eigvalsh(C)[:, :0:-1], 0.0))
    wavelength = medium.wavelength(array.transducer.frequency)
    with np.errstate(divide="ignore"):
        return np.asarray(wavelength / (2.0 * math.sqrt(3.0) * np.where(sigma > 1e-6, sigma, 0.0)))


def focal_area(
    array: Array,
    points: ArrayLike,
    medium: Air,
    normals: ArrayLike | None = None,
    *,
    uniform: bool = False,
) -> Floats:
    """Return the force of a focus divided by the radiation pressure at its centre, (M,) [m^2].

    The force is the integral of the radiation pressure on a plane through the focus, over the main lobe, which ends
    where the pressure first stops falling. The result is 0.86 pi / (k^2 sqrt(det C)), with C in that plane. This is
    within 7 % of the integral for flat filled, sparse and random arrays at 0.08 to 0.4 m, and within 15 % for an array
    folded by 30 degrees. For a ring, it may be far off (docs/concepts.md). Infinite if there is no focus, because sound
    arrives from one transducer only, from none, or from transducers in a line.

    array: N transducers. points: (M, 3) [m]. medium: the air. normals: of the skin, outward, (M, 3); zero, or None,
    for a plane perpendicular to the arriving sound. If there is a normal, sound is weighted by the cosine of its
    incidence (`SkinFacing`). uniform: whether all transducers are driven equally (w = |B|), as by
    `single-focus`; otherwise in proportion to their sound at the focus, which takes the least power (w = |B|^2), as by
    `lagrange`. Raises ArgumentError, PointOnTransducer.
    """
    check_medium(medium)
    q = check_numbers("points", points, (None, 3))
    n = np.zeros_like(q) if normals is None else check_numbers("normals", normals, (None, 3))
    if len(n) != len(q):
        raise ArgumentError("normals", f"must be one for each of {len(q)} points, not {len(n)}")
    mean, C = _spread(array, q, n, medium, uniform=uniform)
    n = np.where(n.any(axis=1, keepdims=True), n, mean)
    n = n / np.maximum(np.sqrt((n * n).sum(axis=1, keepdims=True)), MIN_LENGTH)
    adjugate = np.cross(C[:, (1, 2, 0)], C[:, (2, 0, 1)])
    det = np.einsum("mi,mij,mj->m", n, adjugate, n)  # of C in the plane
    k = medium.wavenumber(array.transducer.frequency)
    with np.errstate(divide="ignore"):
        return np.asarray(MAIN_LOBE * math.pi / (k * k * np.sqrt(np.where(det > 1e-12, det, 0.0))))


def _spread(
    array: Array, q: Floats, n: Floats, medium: Air, *, uniform: bool = False
) -> tuple[Floats, Floats]:
    """Return mean, (M, 3), and covariance, (M, 3, 3), of the unit vectors from points q, (M, 3), to the transducers."""
    from pacinian.native.acoustics import spread

    B = np.empty((len(q), len(array)), dtype=np.complex64)
    KernelData.prepare(array, medium).matrix(q, B)
    mean, C = np.empty((len(q), 3)), np.empty((len(q), 3, 3))
    spread(np.ascontiguousarray(q), np.ascontiguousarray(n), array.positions, B, uniform, mean, C)
    return mean, C
