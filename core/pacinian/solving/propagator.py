"""The propagator: B and what follows from it, each made when asked for and kept while valid."""

from __future__ import annotations

import itertools
import os
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeVar, cast

import numpy as np
from scipy.linalg import blas

from pacinian.acoustics.propagation import KernelData, Precision
from pacinian.errors import ArgumentError
from pacinian.native import solving as kernels
from pacinian.solving.buffer_pool import acquire, release
from pacinian.solving.factor import Factor
from pacinian.types import Complexes, Floats, Gains, Indices

if TYPE_CHECKING:
    from pacinian.acoustics.air import Air
    from pacinian.acoustics.array import Array
    from pacinian.acoustics.skin_facing import SkinFacing
    from pacinian.solving.quiet_subspace import QuietSubspace

A = TypeVar("A", Floats, Complexes)


TILE = 512  # columns at a time: the real and imaginary parts of 64 rows fill a second-level cache
MIN_PARALLEL_ROWS = 128  # rows from which the Gram matrix is made by all cores
MAX_UPDATE_SHARE = 10  # rows of the Gram matrix are made anew one by one up to a share of 1 / FEW


@dataclass
class CacheStats:
    """What was done and what was saved, since the propagator was made."""

    rows_built: int = 0
    rows_kept: int = 0
    grams_built: int = 0
    grams_kept: int = 0
    factors_built: int = 0
    factors_kept: int = 0
    solved: int = 0
    solutions_scaled: int = 0
    solutions_kept: int = 0


class Propagator:
    """Equations (4) to (8) for one array, one medium and points that move.

    All solvers share one propagator and its caches. `set_points` says where the points are now: only the
    rows of B and of B B^H whose points moved are made anew. With `facing`, B is weighted by it, and with `nulls` it is
    that of gains which keep zones quiet; so is all that follows from B.
    """

    def __init__(self, array: Array, medium: Air, precision: Precision = "single") -> None:
        self.array, self.medium = array, medium
        self.precision: Precision = precision
        self.dtype = np.dtype(np.complex64 if precision == "single" else np.complex128)
        self._single = precision == "single"
        self.work = CacheStats()
        self.version = 0
        self.quiet: Propagator | None = None
        self.facing: SkinFacing | None = None
        self.nulls: QuietSubspace | None = None
        self._wave = KernelData.prepare(array, medium)
        self._forget(0)

    def _forget(self, count: int) -> None:
        self._points = np.empty((count, 3))
        self._B = np.empty((count, len(self.array)), dtype=self.dtype)
        self._rows = np.arange(count)
        self._fresh = True  # nothing is kept of what was before
        self._gram: Complexes | None = None
        self._powers: Floats | None = None
        self._factors: dict[float, Factor] = {}
        self._spent: list[Factor] = []  # of points that have moved: their space is used again
        self._stale = np.ones(count, dtype=bool)  # rows of the Gram matrix
        self._moved = True  # whether any row is

    def forget(self) -> None:
        """Forget the points; the space stays."""
        self._fresh = True
        self.quiet = None
        self._factors.clear()

    def keep_quiet(self, nulls: QuietSubspace | None) -> None:
        """From the next `set_points` on, B is that of gains without these."""
        self._fresh = self._fresh or nulls is not self.nulls
        self.nulls = nulls

    def set_points(self, points: Floats, facing: SkinFacing | None = None) -> int:
        """Put the points at `points` [m], shape (M, 3); return how many rows of B were rebuilt.

        facing: which way skin faces there, and what hides it; without, all sound counts.
        Raises ArgumentError; PointOnTransducer, and then holds no points.
        """
        if facing is not None and len(facing) != len(points):
            raise ArgumentError("facing", f"must have {len(points)} normals, as many as points")
        if len(points) != len(self._points):
            self._forget(len(points))
        moved = self._rows if self._fresh else _different(points, self._points)
        if facing is not self.facing:
            moved = self._turned(points, facing, moved)
        count = len(moved)
        self.work.rows_built += count
        self.work.rows_kept += len(points) - count
        if not count:
            return 0
        self.version += 1
        self._spent.extend(self._factors.values())
        self._factors.clear()
        self._powers = None
        every = count == len(points)
        here = points if every else points[moved]
        where = slice(None) if every else moved
        try:
            self._wave.matrix(here, self._B, moved)
            if facing is not None:
                facing.weigh(here, self._wave, moved, self._B)
            if self.nulls is not None:
                self._leave_out(self.nulls, here, moved)
        except BaseException:
            self._forget(0)
            raise
        self._fresh = False
        self._stale[where] = True
        self._moved = True
        self._points[where] = here
        return count

    def _leave_out(self, nulls: QuietSubspace, points: Floats, rows: Indices) -> None:
        """Make of these rows of B, of points (K, 3), what they are of gains that keep zones quiet."""
        B = self._B if len(rows) == len(self._B) else self._B[rows]
        nulls.leave_out(B, points)
        if B is not self._B:
            self._B[rows] = B

    def _turned(self, points: Floats, facing: SkinFacing | None, moved: Indices) -> Indices:
        """Rows `moved`, (K,), and those for which other sound counts now."""
        before, self.facing = self.facing, facing
        if len(moved) == len(points):
            return moved
        if facing is None or before is None:
            return self._rows
        turned = facing.moved(before, points)
        turned[moved] = True
        return np.flatnonzero(turned)

    @property
    def origin(self) -> Floats:
        """The array's centre [m], shape (3,)."""
        return self._wave.origin

    @property
    def points(self) -> Floats:
        """Where the points are [m], shape (M, 3); not to be written to."""
        return _sealed(self._points)

    @property
    def B(self) -> Complexes:
        """Sound pressure at each point per unit gain [Pa], shape (M, N); not to be written to."""
        return _sealed(self._B)

    @property
    def single(self) -> Gains:
        """B in single precision, for the kernels; not to be written to."""
        if self._single:
            return cast("Gains", self._B)
        return self._B.astype(np.complex64)

    @property
    def gram(self) -> Complexes:
        """B B^H [Pa^2], shape (M, M), complex128; not to be written to."""
        if self._gram is not None and not self._moved:
            self.work.grams_kept += 1
            return self._gram
        self.work.grams_built += 1
        made = self._gram
        rows = () if made is None else np.flatnonzero(self._stale)
        if made is None or len(rows) > len(self._stale) / MAX_UPDATE_SHARE:
            made = gram_matrix(self._B, made)
        else:
            made.flags.writeable = True
            for m in rows:  # a row of B B^H is conj(B b_m^H)
                made[:, m] = self.apply(self._B[m].conj())
                made[m] = made[:, m].conj()
                made[m, m] = made[m, m].real
        made.flags.writeable = False
        self._gram, self._moved = made, False
        self._stale[:] = False
        return made

    @property
    def power(self) -> float:
        """trace(B B^H) / M [Pa^2]: the mean square pressure that all transducers at full drive add up to."""
        return float(self.powers.sum()) / max(1, len(self._points))

    @property
    def powers(self) -> Floats:
        """The diagonal of B B^H [Pa^2], (M,); not to be written to."""
        if self._powers is None:
            made = np.empty(len(self._points))
            if self._gram is not None and not self._moved:
                made[:] = self._gram.diagonal().real
            else:
                kernels.powers(self._B, made)
            made.flags.writeable = False
            self._powers = made
        return self._powers

    def factor(self, mu: float) -> Factor:
        """A Cholesky factor of B B^H + mu I; mu: [Pa^2]."""
        kept = self._factors.get(mu)
        if kept is not None:
            self.work.factors_kept += 1
            return kept
        self.work.factors_built += 1
        buffer = self._spent.pop().upper if self._spent else None
        factor = self._factors[mu] = Factor.of(self.gram, mu, buffer)
        return factor

    def apply(self, g: Complexes) -> Complexes:
        """P = B g [Pa], shape (M,), complex128, for gains of shape (N,)."""
        if not self._single:
            return np.asarray(self._B @ g, np.complex128)
        p = np.empty(len(self._B), dtype=np.complex128)
        kernels.apply(self.single, np.asarray(g, np.complex64, order="C"), p)
        return p

    def adjoint(self, y: Complexes) -> Complexes:
        """B^H y, shape (N,), of B's precision, for y of shape (M,)."""
        if not self._single:
            return np.asarray((y.conj() @ self._B).conj())
        x = np.empty(self._B.shape[1], dtype=np.complex64)
        kernels.adjoint(self.single, np.ascontiguousarray(y, dtype=np.complex128), x)
        return x


def _different(a: Floats, b: Floats) -> Indices:
    """The rows in which a and b, (M, 3), differ."""
    return np.flatnonzero((a != b).any(axis=1))


def _sealed(array: A) -> A:
    """A view that cannot be written to: solvers are given the caches themselves."""
    view = array.view()
    view.flags.writeable = False
    return view


def gram_matrix(B: Complexes, out: Complexes | None = None) -> Complexes:
    """B B^H, exactly Hermitian, complex128; from single precision by the kernel, else by BLAS.

    out: (M, M), to write it to.
    """
    M = len(B)
    if out is None:
        out = np.empty((M, M), dtype=np.complex128)
    out.flags.writeable = True
    if B.dtype == np.complex64:
        _single_gram(np.ascontiguousarray(B), out)
    else:
        upper = blas.zherk(1.0, B.T, trans=2)  # conj(B B^H), upper triangle
        np.add(np.triu(upper).conj(), np.triu(upper, 1).T, out=out)
    return out


def _single_gram(B: Gains, out: Complexes) -> None:
    """Write B B^H to `out`; many rows on all cores, each with a share of the columns."""
    M, N = B.shape
    workers = 1 if M < MIN_PARALLEL_ROWS else min(os.cpu_count() or 1, 1 + N // 512)

    def part(start: int, stop: int, out: Complexes) -> Complexes:
        key = "columns", M
        scratch = acquire(key, lambda: np.empty((2, M + M % 2, TILE), np.float32))
        kernels.gram(B, start, stop, scratch, out)
        release(key, scratch)
        return out

    if workers == 1:
        part(0, N, out)
        return
    edges = [N * k // workers for k in range(workers + 1)]
    with ThreadPoolExecutor(workers) as pool:
        parts = [
            pool.submit(part, start, stop, np.empty_like(out) if start else out)
            for start, stop in itertools.pairwise(edges)
        ]
    for done in parts[1:]:
        out += done.result()
