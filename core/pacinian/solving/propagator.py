"""The propagator: B and what follows from it, each made when asked for and kept while valid."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeVar, cast

import numpy as np
from scipy.linalg import blas, lapack

from pacinian.acoustics.propagation import Precision, Wave
from pacinian.solving import kernels, passes
from pacinian.types import Complexes, Floats, Gains

if TYPE_CHECKING:
    from pacinian.acoustics.air import Air
    from pacinian.acoustics.array import Array

A = TypeVar("A", Floats, Complexes)


@dataclass
class Work:
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


@dataclass(frozen=True, eq=False)
class Factor:
    """A Cholesky factor of a matrix, (M, M), complex128; definite: whether the matrix has one."""

    matrix: Complexes
    upper: Complexes
    definite: bool

    @property
    def reciprocal_condition(self) -> float:
        """LAPACK's estimate; 0 where the matrix is not positive definite."""
        if not self.definite:
            return 0.0
        norm = float(np.abs(self.matrix).sum(axis=0).max())
        reciprocal, _ = lapack.zpocon(self.upper, norm)
        return float(reciprocal)

    def solve(self, y: Complexes) -> Complexes:
        """(B B^H + mu I)^-1 y, for y of shape (M,) or (M, K)."""
        x, _ = lapack.zpotrs(self.upper, y)
        return cast("Complexes", x.reshape(y.shape))


class Propagator:
    """Equations (4) to (8) for one array, one medium and points that move.

    All solvers share one propagator and its caches. `place` says where the points are now: only the
    rows of B and of B B^H whose points moved are made anew.
    """

    def __init__(self, array: Array, medium: Air, precision: Precision = "single") -> None:
        self.array, self.medium = array, medium
        self.precision: Precision = precision
        self.dtype = np.dtype(np.complex64 if precision == "single" else np.complex128)
        self.work = Work()
        self.version = 0
        self.quiet: Propagator | None = None
        self._wave = Wave.prepare(array, medium)
        self._forget(0)

    def _forget(self, count: int) -> None:
        self._points = np.empty((count, 3))
        self._B = np.empty((count, len(self.array)), dtype=self.dtype)
        self._fresh = True  # nothing is kept of what was before
        self._gram: Complexes | None = None
        self._power: float | None = None
        self._factors: dict[float, Factor] = {}
        self._stale = np.ones(count, dtype=bool)  # rows of the Gram matrix
        self._moved = True  # whether any row is

    def place(self, points: Floats) -> int:
        """Put the points at `points` [m], shape (M, 3); return how many rows of B were rebuilt.

        Raises PointOnTransducer, and then holds no points.
        """
        if len(points) != len(self._points):
            self._forget(len(points))
        moved = (
            np.arange(len(points))
            if self._fresh
            else np.flatnonzero((points != self._points).any(axis=1))
        )
        count = len(moved)
        self.work.rows_built += count
        self.work.rows_kept += len(points) - count
        if not count:
            return 0
        self.version += 1
        self._factors.clear()
        self._power = None
        try:
            self._wave.matrix(points if count == len(points) else points[moved], self._B, moved)
        except BaseException:
            self._forget(0)
            raise
        self._fresh = False
        self._stale[moved] = True
        self._moved = True
        self._points[moved] = points if count == len(points) else points[moved]
        return count

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
        return self._B.astype(np.complex64, copy=False)

    @property
    def gram(self) -> Complexes:
        """B B^H [Pa^2], shape (M, M), complex128; not to be written to."""
        if self._gram is not None and not self._moved:
            self.work.grams_kept += 1
            return self._gram
        self.work.grams_built += 1
        if self._gram is None or self._stale.sum() > len(self._stale) / 4:
            made = gram(self._B)
        else:
            rows, made = self._stale, self._gram
            made.flags.writeable = True
            fresh = (self._B @ self._B[rows].conj().T).conj().T
            made[rows] = fresh
            made[:, rows] = fresh.conj().T
            made[rows, rows] = made[rows, rows].real
        made.flags.writeable = False
        self._gram, self._moved = made, False
        self._stale[:] = False
        return made

    @property
    def power(self) -> float:
        """trace(B B^H) / M [Pa^2]: the mean square pressure that all transducers at full drive add up to."""
        if self._power is None:
            M = len(self._points)
            if len(self.array) >= M:
                self._power = float(self.gram.trace().real) / max(1, M)
            else:
                self._power = float(np.vdot(self._B, self._B).real) / M
        return self._power

    def factor(self, mu: float) -> Factor:
        """A Cholesky factor of B B^H + mu I; mu: [Pa^2]."""
        kept = self._factors.get(mu)
        if kept is not None:
            self.work.factors_kept += 1
            return kept
        self.work.factors_built += 1
        factor = self._factors[mu] = cholesky(self.gram, mu)
        return factor

    def apply(self, g: Complexes) -> Complexes:
        """P = B g [Pa], shape (M,), complex128, for gains of shape (N,)."""
        if self._B.dtype != np.complex64:
            return np.asarray(self._B @ g, np.complex128)
        p = np.empty(len(self._B), dtype=np.complex128)
        passes.apply(self.single, np.ascontiguousarray(g, dtype=np.complex64), p)
        return p

    def adjoint(self, y: Complexes) -> Complexes:
        """B^H y, shape (N,), of B's precision, for y of shape (M,)."""
        if self._B.dtype != np.complex64:
            return np.asarray((y.conj() @ self._B).conj())
        x = np.empty(self._B.shape[1], dtype=np.complex64)
        passes.adjoint(self.single, np.ascontiguousarray(y, dtype=np.complex128), x)
        return x


def _sealed(array: A) -> A:
    """A view that cannot be written to: solvers are given the caches themselves."""
    view = array.view()
    view.flags.writeable = False
    return view


def gram(B: Complexes) -> Complexes:
    """B B^H, exactly Hermitian, complex128; from single precision by the kernel, else by BLAS."""
    M = len(B)
    if B.dtype == np.complex64:
        out = np.empty((M, M), dtype=np.complex128)
        scratch = np.empty((2, M + M % 2, kernels.TILE), dtype=np.float32)
        kernels.gram(np.ascontiguousarray(B), scratch, out)
        return out
    upper = blas.zherk(1.0, B.T, trans=2)  # conj(B B^H), upper triangle
    return np.asarray(np.triu(upper).conj() + np.triu(upper, 1).T)


def cholesky(gram: Complexes, mu: float) -> Factor:
    """A Cholesky factor of `gram` + mu I."""
    shifted = gram.copy()
    shifted.reshape(-1)[:: len(gram) + 1] += mu
    upper, info = lapack.zpotrf(shifted, overwrite_a=0)
    return Factor(shifted, upper, info == 0)
