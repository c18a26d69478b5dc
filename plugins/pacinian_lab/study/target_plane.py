"""Data that all tasks of one place share, each item computed on first use."""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy import linalg
from scipy.spatial import cKDTree

import pacinian as pc
from pacinian_lab.study import focus

if TYPE_CHECKING:
    from pacinian.types import Complexes, Flags, Floats
    from pacinian_lab.study.planes import Plane
    from pacinian_lab.study.study_file import Picture

CHUNK = 100_000  # elements of B at a time, few enough that the kernel starts no second thread


@dataclass(frozen=True, eq=False)
class TargetPlane:
    """An array, and points of a plane with targets.

    uv: the points in the plane [m], (M, 2). proportions: (M,), 0 for silence.
    """

    array: pc.Array
    plane: Plane
    uv: Floats
    proportions: Floats
    medium: pc.Air
    picture: Picture

    @functools.cached_property
    def points(self) -> Floats:
        """The points, (M, 3) [m]."""
        return self.plane.points(self.uv)

    @functools.cached_property
    def asked(self) -> Flags:
        """Which points have a target above 0, (M,)."""
        return self.proportions > 0.0

    @functools.cached_property
    def B(self) -> Complexes:
        """B, (M, N) [Pa], in double precision. Raises PointOnTransducer."""
        return pc.matrix(self.array, self.points, self.medium)

    @functools.cached_property
    def reach(self) -> Floats:
        """Sound pressure of a focus at full drive, at each point with a target [Pa]: sum_n |B_mn|."""
        return np.asarray(np.abs(self.B[self.asked]).sum(axis=1))

    @functools.cached_property
    def spectrum(self) -> tuple[int, float]:
        """Rank and condition number of B, s_1 / s_min(M, N); infinite if B has less than full rank.

        Singular values count towards the rank if they exceed max(M, N) times the precision, times the largest.
        """
        s = linalg.svdvals(self.B)
        rank = int((s > max(self.B.shape) * np.finfo(np.float64).eps * s[0]).sum())
        return rank, float(s[0] / s[-1]) if rank == len(s) else math.inf

    @functools.cached_property
    def widths(self) -> focus.Widths:
        """Widths of a focus at the plane's origin."""
        return focus.widths(self.array, self.plane.origin, self.medium)

    @functools.cached_property
    def aperture(self) -> float:
        """Longest side of the array's bounding box [m]."""
        return float(np.ptp(self.array.positions, axis=0).max())

    @functools.cached_property
    def spacing(self) -> float:
        """Mean distance from a transducer to the nearest other one [m]; infinite for a single one."""
        distances, _ = self._tree.query(self.array.positions, k=2)
        return float(np.asarray(distances)[:, 1].mean())

    @functools.cached_property
    def pixels(self) -> Floats:
        """The picture's points in the plane [m], (K, K, 2), row by row along u."""
        K = 1 + round(self.picture.side / self.picture.step)
        line = self.picture.step * (np.arange(K) - (K - 1) / 2.0)
        u, v = np.meshgrid(line, line)
        return np.asarray(np.stack([u, v], axis=-1), np.float64)

    @functools.cached_property
    def seen(self) -> Flags:
        """Which pixels count, (K, K): those at least half a wavelength from any transducer."""
        near = 0.5 * self.medium.wavelength(self.array.transducer.frequency)
        distance, _ = self._tree.query(self.plane.points(self.pixels), distance_upper_bound=near)
        return np.asarray(np.isinf(distance))

    @functools.cached_property
    def lobes(self) -> Flags:
        """Which pixels are in the main lobe of a point with a target, (K, K)."""
        uv = self.uv[self.asked]
        shapes = focus.lobes(self.array, self.points[self.asked], self.plane.axes, self.medium)
        return focus.within(self.pixels, uv, shapes)

    def field(self, gains: Complexes) -> Floats:
        """Return |p| [Pa] in the picture, (K, K), with NaN in pixels that do not count."""
        p = np.full(self.seen.shape, np.nan)
        p[self.seen] = amplitude(
            self.array, gains, self.plane.points(self.pixels[self.seen]), self.medium
        )
        return p

    @functools.cached_property
    def _tree(self) -> cKDTree:
        return cKDTree(self.array.positions)


def amplitude(array: pc.Array, gains: Complexes, points: Floats, medium: pc.Air) -> Floats:
    """Return |p| [Pa] at points (M, 3) [m], in single precision, with one thread."""
    rows = max(1, CHUNK // len(array))
    parts = [
        np.abs(pc.field(array, gains, points[first : first + rows], medium))
        for first in range(0, len(points), rows)
    ]
    return np.concatenate([*parts, np.zeros(0)])
