"""The field on a regular grid, interpolated from fewer points where it is smooth enough.

Away from the transducers sound has no detail finer than half a wavelength, and a picture of it has several points
there. Along each axis the field is taken as a series of Chebyshev polynomials of sin(a x), whose nodes are almost even,
so that little more than two of them for each wavelength do (Kosloff and Tal-Ezer, J. Comput. Phys. 104, 1993). It is
evaluated by the barycentric formula (Berrut and Trefethen, SIAM Review 46, 2004). Whether the nodes were enough is seen
from the last coefficients: they are large wherever there is detail that the nodes do not resolve, beside a transducer
or where the sound of one ends; and from some points of the grid, where the field is computed beside.
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

MORE = 20  # nodes along an axis beyond two for each wavelength
EVEN = 1e-5  # error that lets the nodes be so even
LAST = 3  # coefficients that are looked at
SMALL = 1e-4  # of the largest pressure: what they may be
PROBES = 9  # points along an axis, corners among them, where the field is computed beside
WRONG = 4e-4  # of the largest pressure: what may be missed there
PAYS = 0.7  # of the grid's points: with more nodes than that there is nothing to win


@dataclass(frozen=True)
class InterpolatedField:
    """Points origin + i steps[0] + j steps[1] + ... [m], for i < shape[0], j < shape[1], ..., the last one fastest."""

    origin: tuple[float, ...]
    steps: tuple[tuple[float, ...], ...]
    shape: tuple[int, ...]

    @property
    def points(self) -> Floats:
        """All of them [m], shape (*shape, 3)."""
        return self._at([np.arange(count, dtype=np.float64) for count in self.shape])

    def _at(self, places: list[Floats]) -> Floats:
        """Where the places along each axis, in steps, meet [m]."""
        found = np.array(self.origin)
        for along, step in zip(places, np.array(self.steps), strict=True):
            found = found[..., None, :] + along[:, None] * step
        return found

    def field(self, array: Array, gains: ArrayLike, medium: Air) -> Complexes | None:
        """Complex sound pressure [Pa] at its points, shape `shape`, by interpolation; None where that would not do.

        |p|^2 is within 0.2 % of its largest. array, gains, medium: as of `propagation.field`. Raises ArgumentError.
        """
        turns = medium.wavenumber(array.transducer.frequency) / (2.0 * math.pi)
        lengths = np.linalg.norm(self.steps, axis=1) * (np.array(self.shape) - 1)
        counts = [math.ceil(2.0 * turns * length) + MORE for length in lengths]
        if math.prod(counts) > PAYS * math.prod(self.shape):
            return None
        axes = [_axis(*each) for each in zip(self.shape, counts, strict=True)]
        some = [np.linspace(0.0, K - 1.0, min(K, PROBES)).round() for K in self.shape]
        nodes, probes = self._at([axis.nodes for axis in axes]), self._at(some)
        try:
            found = field(
                array, gains, np.vstack([nodes.reshape(-1, 3), probes.reshape(-1, 3)]), medium
            )
        except PointOnTransducer:
            return None
        p, exact = np.split(found, [math.prod(counts)])
        p, most = p.reshape(counts), np.abs(found).max()
        last = [np.tensordot(axis.last, p, (1, number)) for number, axis in enumerate(axes)]
        if not most or max(np.abs(c).max() for c in last) > SMALL * most:
            return None
        for number, axis in enumerate(axes):
            p = np.moveaxis(np.tensordot(axis.values, p, (1, number)), 0, number)
        off = p[np.ix_(*(places.astype(int) for places in some))].ravel() - exact
        return p if np.abs(off).max() < WRONG * most else None


@dataclass(frozen=True, eq=False)
class Axis:
    """Interpolation along an axis of K points from n nodes.

    nodes: in steps, (n,). values: at the points per value at the nodes, (K, n). last: coefficients, (LAST, n).
    """

    nodes: Floats
    values: Singles
    last: Singles


@functools.lru_cache(maxsize=64)
def _axis(K: int, n: int) -> Axis:
    """Of K points, from n nodes: x = arcsin(a c) / arcsin(a) on -1..1, c: Chebyshev's nodes of the first kind."""
    angles = np.pi * (np.arange(n) + 0.5) / n
    c = np.cos(angles)
    a = 1.0 / math.cosh(math.log(EVEN) / n)
    x = np.arcsin(a * c) / math.asin(a)
    d = (np.sin(np.linspace(-1.0, 1.0, K) * math.asin(a)) / a)[:, None] - c
    d[d == 0.0] = 1e-300
    values = (-1.0) ** np.arange(n) * np.sin(angles) / d
    values /= values.sum(axis=1, keepdims=True)
    last = 2.0 / n * np.cos(np.arange(n - LAST, n)[:, None] * angles)
    return Axis((x + 1.0) / 2.0 * (K - 1), values.astype(np.float32), last.astype(np.float32))
