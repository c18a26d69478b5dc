"""How fine an array can resolve, from the directions under which its transducers are seen."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from pacinian.acoustics.air import Air
from pacinian.acoustics.propagation import Wave
from pacinian.checks import numbers

if TYPE_CHECKING:
    from pacinian.acoustics.array import Array
    from pacinian.types import ArrayLike, Floats


def resolution(array: Array, points: ArrayLike, medium: Air | None = None) -> Floats:
    """How far from a focus its main lobe ends, in the direction in which that is nearest [m], (M,).

    Near a focus at q the field is |B B^H(q, q + d)| / B B^H(q, q) = 1 - k^2 d^T C d / 2, where C is the
    covariance of the unit vectors to the transducers, weighted with |B|^2. Directions that spread evenly
    with the variance sigma^2, C's largest, make the first null at lambda / (2 sqrt(3) sigma).
    Infinite where a single transducer is heard, or none.

    array: N transducers. points: [m], (M, 3). medium: `Air()` unless given. Raises ArgumentError; PointOnTransducer.
    """
    medium = medium or Air()
    q = numbers("points", points, (None, 3))
    B = np.empty((len(q), len(array)), dtype=np.complex64)
    Wave.prepare(array, medium).matrix(q, B)
    size = B.real**2 + B.imag**2  # (M, N) [Pa^2]
    share = (size / np.maximum(size.sum(axis=1, keepdims=True), 1e-30)).astype(np.float64)
    u = array.positions - q[:, None]  # (M, N, 3)
    u /= np.maximum(np.sqrt((u * u).sum(axis=2, keepdims=True)), 1e-30)
    mean = (share[:, None] @ u)[:, 0]  # (M, 3)
    u -= mean[:, None]
    C = (share[..., None] * u).transpose(0, 2, 1) @ u
    sigma = np.sqrt(np.maximum(np.linalg.eigvalsh(C)[:, -1], 0.0))
    wavelength = medium.wavelength(array.transducer.frequency)
    with np.errstate(divide="ignore"):
        return np.asarray(wavelength / (2.0 * math.sqrt(3.0) * np.where(sigma > 1e-6, sigma, 0.0)))
