"""The field on a regular grid, interpolated from fewer points where it is smooth enough.

Away from the transducers, sound has no detail finer than half a wavelength, while a picture has several points in half
a wavelength. Along each axis, the field is expanded in Chebyshev polynomials of sin(a x). Their nodes are almost evenly
spaced, so that little more than two nodes per wavelength suffice (Kosloff and Tal-Ezer, J. Comput. Phys. 104, 1993).
The series is evaluated by the barycentric formula (Berrut and Trefethen, SIAM Review 46, 2004).

Two checks decide whether the nodes were enough. The last coefficients are large if there is detail that the nodes do
not resolve, for example near a transducer, or at the edge of its radiation. And at some grid points, the field is also
computed directly.
"""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from pacinian.acoustics.propagation import field
from pacinian.errors import PointOnTransducer

if TYPE_CHECKING:
    from pacinian.acoustics.air import Air
    from pacinian.acoustics.array import Array
    from pacinian.types import ArrayLike, Complexes, Floats, Singles

EXTRA_NODES = 20  # nodes along an axis, in addition to two per wavelength
EVENNESS_ERROR = 1e-5  # error accepted in return for almost even nodes
CHECKED_COEFFICIENTS = 3  # highest coefficients along an axis that are checked
MAX_REMAINDER = 1e-4  # largest checked coefficient, relative to the largest pressure
PROBES = 9  # check points along an axis, including corners, where the field is computed directly
MAX_PROBE_ERROR = 4e-4  # largest error at a check point, relative to the largest pressure
MAX_NODE_SHARE = 0.7  # largest ratio of nodes to grid points at which interpolation saves time


@dataclass(frozen=True)
class RegularGrid:
    """The points origin + i steps[0] + j steps[1] + ... [m], i < shape[0], j < shape[1], ...

    The last index varies fastest.
    """

    origin: tuple[float, ...]
    steps: tuple[tuple[float, ...], ...]
    shape: tuple[int, ...]

    @property
    def points(self) -> Floats:
        """The points [m], shape (*shape, 3)."""
        return self._compute_points([np.arange(count, dtype=np.float64) for count in self.shape])

    def _compute_points(self, places: list[Floats]) -> Floats:
        """Return the grid points [m] for the given positions along each axis, in units of its step."""
        found = np.array(self.origin)
        for along, step in zip(places, np.array(self.steps), strict=True):
            found = found[..., None, :] + along[:, None] * step
        return found

    def interpolate_field(self, array: Array, gains: ArrayLike, medium: Air) -> Complexes | None:
        """Return the complex sound pressure [Pa] at the points, shape `shape`, by interpolation.

        Errors of |p|^2 are within 0.2 % of its largest value. Returns None if interpolation is too inaccurate, or would
        not save time. array, gains, medium: as for `propagation.field`. Raises ArgumentError.
        """
        turns = medium.wavenumber(array.transducer.frequency) / (2.0 * math.pi)
        lengths = np.linalg.norm(self.steps, axis=1) * (np.array(self.shape) - 1)
        counts = [math.ceil(2.0 * turns * length) + EXTRA_NODES for length in lengths]
        if math.prod(counts) > MAX_NODE_SHARE * math.prod(self.shape):
            return None
        axes = [_axis(*each) for each in zip(self.shape, counts, strict=True)]
        some = [np.linspace(0.0, K - 1.0, min(K, PROBES)).round() for K in self.shape]
        nodes, probes = (
            self._compute_points([axis.nodes for axis in axes]),
            self._compute_points(some),
        )
        try:
            found = field(
                array, gains, np.vstack([nodes.reshape(-1, 3), probes.reshape(-1, 3)]), medium
            )
        except PointOnTransducer:
            return None
        p, exact = np.split(found, [math.prod(counts)])
        p, most = p.reshape(counts), np.abs(found).max()
        last = [np.tensordot(axis.last, p, (1, number)) for number, axis in enumerate(axes)]
        if not most or max(np.abs(c).max() for c in last) > MAX_REMAINDER * most:
            return None
        for number, axis in enumerate(axes):
            p = np.moveaxis(np.tensordot(axis.values, p, (1, number)), 0, number)
        off = p[np.ix_(*(places.astype(int) for places in some))].ravel() - exact
        return p if np.abs(off).max() < MAX_PROBE_ERROR * most else None


@dataclass(frozen=True, eq=False)
class Axis:
    """Interpolation from n nodes to K points along one axis.

    nodes: positions in steps, (n,). values: matrix from values at the nodes to values at the points, (K, n). last:
    matrix from values at the nodes to the last coefficients, (CHECKED_COEFFICIENTS, n).
    """

    nodes: Floats
    values: Singles
    last: Singles


@functools.lru_cache(maxsize=64)
def _axis(K: int, n: int) -> Axis:
    """Make an axis of K points from n nodes x = arcsin(a c) / arcsin(a) on -1..1; c: Chebyshev nodes, first kind."""
    angles = np.pi * (np.arange(n) + 0.5) / n
    c = np.cos(angles)
    a = 1.0 / math.cosh(math.log(EVENNESS_ERROR) / n)
    x = np.arcsin(a * c) / math.asin(a)
    d = (np.sin(np.linspace(-1.0, 1.0, K) * math.asin(a)) / a)[:, None] - c
    d[d == 0.0] = 1e-300
    values = (-1.0) ** np.arange(n) * np.sin(angles) / d
    values /= values.sum(axis=1, keepdims=True)
    last = 2.0 / n * np.cos(np.arange(n - CHECKED_COEFFICIENTS, n)[:, None] * angles)
    return Axis((x + 1.0) / 2.0 * (K - 1), values.astype(np.float32), last.astype(np.float32))
