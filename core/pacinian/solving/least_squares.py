"""Minimum-norm least squares, min ||g|| among all g that minimise ||B g - p||, for B of any shape and rank.

First, equal rows and columns of B are merged. After this, the paper's cases 2a and 2b, with rank 451 of 861, have full
rank. Then the smaller Gram matrix, B^H B (if M > N) or B B^H, is factored by Cholesky in single precision. The
resulting pseudo-inverse X need not be exact, because refinement steps g <- g + X (p - B g) reduce the error to the
precision of B. If they do not reduce it, X is not good enough. Then the same is tried in double precision, and last a
singular value decomposition.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from pacinian.solving.budget import Budget
from pacinian.solving.column_groups import ColumnGroups
from pacinian.solving.linalg import blas, lapack

if TYPE_CHECKING:
    from pacinian.types import Complexes

SINGLE, DOUBLE = np.dtype(np.complex64), np.dtype(np.complex128)
PHASE_ROUNDING = 2e-5  # rounding error of phases in single precision, at a distance of 0.4 m [rad]
# Smallest reciprocal condition number of the Gram matrix at which its factor is used. For a singular matrix, LAPACK
# returns 1e-8 (single) or 1e-16 (double), or less.
MIN_RECIPROCAL_CONDITION: dict[np.dtype[Any], float] = {SINGLE: 2e-6, DOUBLE: 1e-12}
MAX_STEPS = 20  # largest number of refinement steps; 2 or 3 are usual
# Estimated times of a factor in double precision and of singular values, over that of a factor in single precision.
DOUBLE_TIME, SINGULAR_TIME = 3.0, 16.0
MAX_FIRST_STEP = 0.1  # largest length of the first step, relative to g, at which X is good enough


@dataclass(frozen=True, eq=False)
class LeastSquares:
    """The pseudo-inverse of a matrix, prepared once and applied to many targets.

    B: the matrix times 2^shift, with equal rows and columns merged, (m, n). rcond: singular values below this fraction
    of the largest count as zero.
    """

    B: Complexes
    shift: int
    rows: ColumnGroups
    columns: ColumnGroups
    rcond: float

    @classmethod
    def of(cls, B: Complexes, rcond: float | None = None) -> LeastSquares:
        """Prepare a finite B of shape (M, N); rcond: by default max(M, N) times its precision."""
        rounding = compute_rounding_share(B)
        rcond = rounding if rcond is None else rcond
        B, shift = scale_matrix(B)
        columns = ColumnGroups.of(B, min(rcond, rounding))
        B = columns.merge(B)
        rows = ColumnGroups.of(B.T, min(rcond, rounding))
        return cls(rows.merge(B, axis=0), shift, rows, columns, rcond)

    def solve(self, p: Complexes) -> tuple[Complexes, str]:
        """Return gains, (N,), complex128, for targets p, (M,), and a note on the method used.

        The result has double precision if B is complex128, and the rounding of B g in single precision if B is
        complex64. The largest |B_mn| and |p_m| may be 1e-150 to 1e150, or 0.
        """
        found = self.solve_within(p, Budget())
        assert found is not None
        return found

    def solve_within(self, p: Complexes, budget: Budget) -> tuple[Complexes, str] | None:
        """Do the same as `solve`; return None before a step that would end after the deadline, except the first."""
        size = float(np.abs(p).max(initial=0.0)) or 1.0
        q = self.rows.gather(p / size)
        rank, full = min(self.B.shape), min(len(self.rows.group), len(self.columns.group))
        g: Complexes | None = np.zeros(self.B.shape[1], np.complex128)
        seconds = 0.0
        if rank:
            g, seconds = self._refine_gains(q, budget)
        how = "Cholesky"
        if g is None:
            if not budget.affords(SINGULAR_TIME * seconds):
                return None
            B = self.B.astype(np.complex128)
            h, _, rank, _ = np.linalg.lstsq(B, q, rcond=self.rcond)
            g, how = h, "singular values"
        return self.columns.spread(g) * (size * 2.0**self.shift), f"{how}: rank {rank} of {full}"

    def _refine_gains(self, p: Complexes, budget: Budget) -> tuple[Complexes | None, float]:
        """Return gains from the first factor that is good enough, None if none is; and the time of the first [s]."""
        least = 3.0 * self.rcond**2  # the condition number is an estimate
        start, seconds = budget.clock(), 0.0
        for dtype, trusted in MIN_RECIPROCAL_CONDITION.items():
            if dtype not in self._normals:
                if seconds and not budget.affords(DOUBLE_TIME * seconds):
                    break
                self._normals[dtype] = Normal.of(self.B.astype(dtype, copy=False))
            normal = self._normals[dtype]
            if normal.reciprocal_condition > max(least, trusted):
                g = refine(self.B, normal, p)
                if g is not None:
                    return g, seconds
            seconds = seconds or budget.clock() - start
            if normal.reciprocal_condition < least - 1e-7:  # double precision would not help
                break
        return None, seconds

    @cached_property
    def _normals(self) -> dict[np.dtype[Any], Normal]:
        """The factors computed so far, by precision."""
        return {}


@dataclass(frozen=True, eq=False)
class Reduced:
    """B = Q R with orthonormal Q, (M, r): ||B g - p||^2 = ||R g - Q^H p||^2 + ||p||^2 - ||Q^H p||^2.

    R: shape (r, N), complex128, r <= min(M, N); equal columns of B are equal in R.
    """

    R: Complexes
    basis: Complexes  # (M, r), Q, or B without its repeated columns
    upper: Complexes | None  # (r, r), or None; if present, conj(basis) = Q conj(upper)

    @classmethod
    def of(cls, B: Complexes) -> Reduced:
        """Reduce a finite B, (M, N), by Cholesky (without forming Q) if its condition allows, else by Householder."""
        B = B.astype(np.complex128, copy=False)
        columns = ColumnGroups.of(B, compute_rounding_share(B))
        basis = columns.merge(B)
        if len(B) > basis.shape[1] > 0:
            normal = Normal.of(basis)
            if normal.reciprocal_condition > MIN_RECIPROCAL_CONDITION[B.dtype]:
                return cls(columns.spread(normal.upper.conj()), basis, normal.upper)
        Q, R = cast("tuple[Complexes, Complexes]", np.linalg.qr(basis))
        return cls(columns.spread(R), Q, None)

    def down(self, p: Complexes) -> Complexes:
        """Return Q^H p, shape (r,), complex128, for p of shape (M,)."""
        q = adjoint(self.basis, p)
        if self.upper is None:
            return q
        q, _ = lapack.ztrtrs(self.upper, q.conj(), trans=2)
        return cast("Complexes", np.conj(q))


@dataclass(frozen=True, eq=False)
class Normal:
    """The Cholesky factor of the smaller Gram matrix: U^H U = conj(B B^H) if M <= N, else conj(B^H B).

    reciprocal_condition: LAPACK's estimate for the Gram matrix; 0 if it is not positive definite.
    """

    upper: Complexes
    reciprocal_condition: float

    @classmethod
    def of(cls, B: Complexes) -> Normal:
        """Compute the factor for B, (M, N), in its precision."""
        single = B.dtype == np.complex64
        M, N = B.shape
        herk = blas.cherk if single else blas.zherk
        gram = herk(1.0, B.T, trans=2 if M <= N else 0)  # the upper triangle, the rest zeros
        size = np.abs(gram)
        norm = float((size.sum(axis=0) + size.sum(axis=1) - size.diagonal()).max())
        upper, info = (lapack.cpotrf if single else lapack.zpotrf)(gram, overwrite_a=1)
        if info:
            return cls(upper, 0.0)
        reciprocal, _ = (lapack.cpocon if single else lapack.zpocon)(upper, norm)
        return cls(upper, float(reciprocal))

    def solve(self, y: Complexes) -> Complexes:
        """Return (B B^H)^-1 y, or (B^H B)^-1 y, complex128, with the accuracy of the factor."""
        size = float(np.abs(y).max()) or 1.0  # normalise, so that y fits single precision
        potrs = lapack.cpotrs if self.upper.dtype == np.complex64 else lapack.zpotrs
        x, _ = potrs(self.upper, (y.conj() / size).astype(self.upper.dtype))
        return cast("Complexes", np.conj(x.ravel()) * np.complex128(size))

    def pseudo_inverse(self, B: Complexes, p: Complexes) -> Complexes:
        """Return B^+ p, shape (N,), complex128, with the accuracy of the factor."""
        M, N = B.shape
        g = adjoint(B, self.solve(p)) if M <= N else self.solve(adjoint(B, p))
        return g.astype(np.complex128, copy=False)


def refine(B: Complexes, normal: Normal, p: Complexes) -> Complexes | None:
    """Return B^+ p, shape (N,), by iterative refinement; None if the factor is not good enough."""
    eps = float(np.finfo(B.dtype).eps)
    g = normal.pseudo_inverse(B, p)
    first = last = float(np.linalg.norm(g))
    for step in range(MAX_STEPS if first else 0):
        d = normal.pseudo_inverse(B, p - B @ g.astype(B.dtype, copy=False))
        length = float(np.linalg.norm(d))
        if not step and not length < MAX_FIRST_STEP * first:
            return None
        if not length < last / 2.0:  # the remaining error is rounding
            break
        g += d
        if length**2 <= eps * first * last:  # the next step would be below rounding
            break
        last = length
    return g


def adjoint(B: Complexes, y: Complexes) -> Complexes:
    """Return B^H y, shape (N,), in the precision of B."""
    return np.conj(y.conj().astype(B.dtype, copy=False) @ B)


def compute_rounding_share(B: Complexes) -> float:
    """Return the fraction of the largest singular value below which others may be due to rounding.

    This is max(M, N) eps; in single precision, at least the rounding of phases, which is 6e-8 k r or more.
    """
    least = PHASE_ROUNDING if B.dtype == np.complex64 else 0.0
    return max(least, float(max(1, *B.shape) * np.finfo(B.dtype).eps))


def scale_matrix(B: Complexes) -> tuple[Complexes, int]:
    """Return B 2^shift, contiguous and scaled so that its squares fit single precision, and the shift."""
    B = np.ascontiguousarray(B)
    parts = B.view(B.real.dtype)
    largest = float(max(parts.max(initial=0.0), -parts.min(initial=0.0)))
    if not largest or 1e-4 < largest < 1e6:
        return B, 0
    shift = -math.frexp(largest)[1]
    return np.ldexp(parts, shift).view(B.dtype), shift
