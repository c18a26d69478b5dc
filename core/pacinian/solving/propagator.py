"""The propagator: B and quantities derived from it, computed on demand and cached while valid."""

from __future__ import annotations

import itertools
import os
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeVar, cast

import numpy as np

from pacinian.acoustics.propagation import KernelData, Precision
from pacinian.errors import ArgumentError
from pacinian.native import solving as kernels
from pacinian.solving.buffer_pool import acquire, release
from pacinian.solving.factor import Factor
from pacinian.solving.linalg import blas
from pacinian.types import Complexes, Floats, Gains, Indices

if TYPE_CHECKING:
    from pacinian.acoustics.air import Air
    from pacinian.acoustics.array import Array
    from pacinian.acoustics.skin_facing import SkinFacing
    from pacinian.solving.quiet_subspace import QuietSubspace

A = TypeVar("A", Floats, Complexes)


# Number of columns of a tile: the real and imaginary parts of 64 rows fill a second-level cache.
TILE = 512
MIN_PARALLEL_ROWS = 128  # number of rows of B from which all cores compute the Gram matrix
# The Gram matrix is updated row by row if at most 1 / MAX_UPDATE_SHARE of the rows have changed.
MAX_UPDATE_SHARE = 10


@dataclass
class CacheStats:
    """Counts of results computed and of results reused, since the propagator was created."""

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
    """Equations (4) to (8) for one array, one medium and moving points.

    All solvers share one propagator and its caches. `set_points` moves the points and recomputes only the rows of B
    and B B^H whose points moved. With `facing`, B is weighted by it. With `quiet_subspace`, B is projected so that
    gains computed from it keep the zones quiet. Both apply to everything derived from B, too.
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
        self.quiet_subspace: QuietSubspace | None = None
        self.postponed = -1
        """The version for whose Gram matrix there was no time (`back_propagation.affords_gram`)."""
        self.workspace: object = None
        """What a solver keeps from one solve to the next to be faster, such as memory and a preconditioner. Results
        must not depend on it beyond their tolerance."""
        self._wave = KernelData.prepare(array, medium)
        self._forget(0)

    def _forget(self, count: int) -> None:
        self._points = np.empty((count, 3))
        self._B = np.empty((count, len(self.array)), dtype=self.dtype)
        self._rows = np.arange(count)
        self._fresh = True  # no row is valid
        self._gram: Complexes | None = None
        self._powers: Floats | None = None
        self._factors: dict[float, Factor] = {}
        self._outdated_factors: list[Factor] = []  # outdated factors, whose memory is reused
        self._stale = np.ones(count, dtype=bool)  # outdated rows of the Gram matrix
        self._moved = True  # whether any row is outdated

    def forget(self) -> None:
        """Invalidate the caches; keep their memory."""
        self._fresh = True
        self.quiet = self.workspace = None
        self._factors.clear()

    def keep_quiet(self, quiet_subspace: QuietSubspace | None) -> None:
        """From the next `set_points` on, project B onto gains without `quiet_subspace`; None to stop."""
        self._fresh = self._fresh or quiet_subspace is not self.quiet_subspace
        self.quiet_subspace = quiet_subspace

    def set_points(self, points: Floats, facing: SkinFacing | None = None) -> int:
        """Move the points to `points` [m], shape (M, 3); return the number of rows of B that were recomputed.

        facing: normals of the skin at the points, and what hides it; None to count all sound.
        Raises ArgumentError and PointOnTransducer; after the latter, the propagator has no points.
        """
        if facing is not None and len(facing) != len(points):
            raise ArgumentError("facing", f"must have {len(points)} normals, as many as points")
        if len(points) != len(self._points):
            self._forget(len(points))
        moved = self._find_changed(points, facing)
        self.facing = facing
        count = len(moved)
        self.work.rows_built += count
        self.work.rows_kept += len(points) - count
        if not count:
            return 0
        self.version += 1
        self._outdated_factors.extend(self._factors.values())
        self._factors.clear()
        self._powers = None
        every = count == len(points)
        here = points if every else points[moved]
        where = slice(None) if every else moved
        try:
            self._wave.matrix(here, self._B, moved)
            if facing is not None:
                facing.weigh(here, self._wave, moved, self._B)
            if self.quiet_subspace is not None:
                self._leave_out(self.quiet_subspace, here, moved)
        except BaseException:
            self._forget(0)
            raise
        self._fresh = False
        self._stale[where] = True
        self._moved = True
        self._points[where] = here
        return count

    def _leave_out(self, quiet_subspace: QuietSubspace, points: Floats, rows: Indices) -> None:
        """Project these rows of B, of `points` (K, 3), onto gains that keep the zones quiet."""
        B = self._B if len(rows) == len(self._B) else self._B[rows]
        quiet_subspace.leave_out(B, points)
        if B is not self._B:
            self._B[rows] = B

    def compute_rows(self, rows: Indices) -> Complexes:
        """Return the rows of B of the points `rows`, (K,), as they would be without quiet zones, (K, N)."""
        points, every = self._points[rows], np.arange(len(rows))
        made = np.empty((len(rows), self._B.shape[1]), self.dtype)
        self._wave.matrix(points, made, every)
        if self.facing is not None:
            self.facing.only(rows).weigh(points, self._wave, every, made)
        return made

    def _find_changed(self, points: Floats, facing: SkinFacing | None) -> Indices:
        """Return the rows of B that `points`, (M, 3) [m], or their facing change."""
        before, rows = self.facing, np.empty(len(points), np.int64)
        if self._fresh or (facing is None) != (before is None):
            return self._rows
        if facing is before or facing is None or before is None:
            return rows[: kernels.moved(points, self._points, rows)]
        if facing.edge != before.edge:
            return self._rows
        return rows[
            : kernels.changed(
                points, self._points, facing.normals, before.normals, facing.capsules, before.capsules, rows
            )
        ]  # fmt: skip

    @property
    def origin(self) -> Floats:
        """The array's centre [m], shape (3,)."""
        return self._wave.origin

    @property
    def points(self) -> Floats:
        """The points [m], shape (M, 3), read-only."""
        return _make_read_only(self._points)

    @property
    def B(self) -> Complexes:
        """Sound pressure at each point per unit gain [Pa], shape (M, N), read-only."""
        return _make_read_only(self._B)

    @property
    def single(self) -> Gains:
        """B in single precision, for the kernels, read-only."""
        if self._single:
            return cast("Gains", self._B)
        return self._B.astype(np.complex64)

    @property
    def gram(self) -> Complexes:
        """The Gram matrix B B^H [Pa^2], shape (M, M), complex128, read-only."""
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
    def has_gram(self) -> bool:
        """Whether `gram` is cached, or only needs an update of a few rows."""
        few = len(self._stale) / MAX_UPDATE_SHARE
        return self._gram is not None and (not self._moved or int(self._stale.sum()) <= few)

    @property
    def power(self) -> float:
        """trace(B B^H) / M [Pa^2]: mean square pressure if all transducers at full drive add up incoherently."""
        return float(self.powers.sum()) / max(1, len(self._points))

    @property
    def powers(self) -> Floats:
        """The diagonal of B B^H [Pa^2], (M,), read-only."""
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
        """Return a Cholesky factor of B B^H + mu I; mu: [Pa^2]."""
        kept = self._factors.get(mu)
        if kept is not None:
            self.work.factors_kept += 1
            return kept
        self.work.factors_built += 1
        buffer = self._outdated_factors.pop().upper if self._outdated_factors else None
        factor = self._factors[mu] = Factor.of(self.gram, mu, buffer)
        return factor

    def apply(self, g: Complexes) -> Complexes:
        """Return p = B g [Pa], shape (M,), complex128, for gains of shape (N,)."""
        if not self._single:
            return np.asarray(self._B @ g, np.complex128)
        p = np.empty(len(self._B), dtype=np.complex128)
        kernels.apply(self.single, np.asarray(g, np.complex64, order="C"), p)
        return p

    def adjoint(self, y: Complexes) -> Complexes:
        """Return B^H y, shape (N,), in B's precision, for y of shape (M,)."""
        if not self._single:
            return np.asarray((y.conj() @ self._B).conj())
        x = np.empty(self._B.shape[1], dtype=np.complex64)
        kernels.adjoint(self.single, np.ascontiguousarray(y, dtype=np.complex128), x)
        return x


def _make_read_only(array: A) -> A:
    """Return a read-only view, because solvers receive the caches themselves."""
    view = array.view()
    view.flags.writeable = False
    return view


def gram_matrix(B: Complexes, out: Complexes | None = None) -> Complexes:
    """Return B B^H, exactly Hermitian, complex128; uses the kernel for single precision, else BLAS.

    out: (M, M), to write the result to.
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


def mean_square(gram: Complexes) -> float:
    """Return trace(B B^H) / M [Pa^2] of a Gram matrix B B^H, (M, M): the scale of its regularisation; 0 if M is 0."""
    return float(gram.diagonal().real.mean()) if len(gram) else 0.0


def _single_gram(B: Gains, out: Complexes) -> None:
    """Write B B^H to `out`. For many rows, divide the columns among all cores."""
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
