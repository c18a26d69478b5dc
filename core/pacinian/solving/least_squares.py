"""min ||B g - p||, of those min ||g||, for any shape and rank, as fast as B allows.

Equal rows and columns of B are merged: what is left of the paper's cases 2a and 2b, rank 451 of 861,
has full rank. Then the smaller Gram matrix, B^H B (M > N) or B B^H, is factored by Cholesky in single
precision. The pseudo-inverse X that this gives need not be exact: steps g <- g + X (p - B g) shrink the
error to what B's own precision leaves, or do not shrink it and so tell that X will not do. Then the
same in double precision, then singular values.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, cast

import numpy as np
from scipy import linalg
from scipy.linalg import blas, lapack

from pacinian.solving.column_groups import ColumnGroups

if TYPE_CHECKING:
    from pacinian.types import Complexes

SINGLE, DOUBLE = np.dtype(np.complex64), np.dtype(np.complex128)
# The Gram matrix's reciprocal condition number from which its factor is used. Of a singular matrix it
# comes out as 1e-8 and 1e-16 or less.
PHASES = 2e-5  # [rad] at 0.4 m
TRUSTED: dict[np.dtype[Any], float] = {SINGLE: 2e-6, DOUBLE: 1e-12}
STEPS = 20  # of refinement at most; 2 or 3 are usual
SHRUNK = 0.1  # the first of them is shorter than this share of g, or X will not do


@dataclass(frozen=True, eq=False)
class LeastSquares:
    """The pseudo-inverse of a matrix, prepared once, applied to targets again and again.

    B: the matrix times 2^shift, its equal rows and columns merged, (m, n). rcond: singular values below
    this share of the largest count as zero.
    """

    B: Complexes
    shift: int
    rows: ColumnGroups
    columns: ColumnGroups
    rcond: float

    @classmethod
    def of(cls, B: Complexes, rcond: float | None = None) -> LeastSquares:
        """For B of shape (M, N), finite; rcond: max(M, N) times its precision unless given."""
        rounding = rounding_share(B)
        rcond = rounding if rcond is None else rcond
        B, shift = scale_matrix(B)
        columns = ColumnGroups.of(B, min(rcond, rounding))
        B = columns.merge(B)
        rows = ColumnGroups.of(B.T, min(rcond, rounding))
        return cls(rows.merge(B, axis=0), shift, rows, columns, rcond)

    def solve(self, p: Complexes) -> tuple[Complexes, str]:
        """Gains (N,), complex128, for targets p (M,), and a note on how they were found.

        For B of complex128 to double precision; of complex64, with the rounding of B g in single
        precision. The largest |B_mn| and |p_m| may be 1e-150 to 1e150, or 0.
        """
        size = float(np.abs(p).max(initial=0.0)) or 1.0
        q = self.rows.gather(p / size)
        rank, full = min(self.B.shape), min(len(self.rows.group), len(self.columns.group))
        g = self._refined(q) if rank else np.zeros(self.B.shape[1], np.complex128)
        how = "Cholesky"
        if g is None:
            B = self.B.astype(np.complex128)
            h, _, rank, _ = linalg.lstsq(B, q, cond=self.rcond, lapack_driver="gelsd")
            g, how = cast("Complexes", h), "singular values"
        return self.columns.spread(g) * (size * 2.0**self.shift), f"{how}: rank {rank} of {full}"

    def _refined(self, p: Complexes) -> Complexes | None:
        """Gains by the first factor that is good enough, if any."""
        least = 3.0 * self.rcond**2  # the condition number is an estimate
        for dtype, trusted in TRUSTED.items():
            if dtype not in self._normals:
                self._normals[dtype] = Normal.of(self.B.astype(dtype, copy=False))
            normal = self._normals[dtype]
            if normal.reciprocal_condition > max(least, trusted):
                g = refine(self.B, normal, p)
                if g is not None:
                    return g
            if normal.reciprocal_condition < least - 1e-7:  # nor would it be in double precision
                break
        return None

    @cached_property
    def _normals(self) -> dict[np.dtype[Any], Normal]:
        """The factors made so far."""
        return {}


@dataclass(frozen=True, eq=False)
class Reduced:
    """B = Q R with orthonormal Q, (M, r): ||B g - p||^2 = ||R g - Q^H p||^2 + ||p||^2 - ||Q^H p||^2.

    R: shape (r, N), complex128, r <= min(M, N); equal columns of B are equal in R.
    """

    R: Complexes
    basis: Complexes  # (M, r), Q, or B without its repeated columns
    upper: Complexes | None  # (r, r), then conj(basis) = Q conj(upper)

    @classmethod
    def of(cls, B: Complexes) -> Reduced:
        """Reduce B, (M, N), finite: by Cholesky, without Q, where its condition allows, else by Householder."""
        B = B.astype(np.complex128, copy=False)
        columns = ColumnGroups.of(B, rounding_share(B))
        basis = columns.merge(B)
        if len(B) > basis.shape[1] > 0:
            normal = Normal.of(basis)
            if normal.reciprocal_condition > TRUSTED[B.dtype]:
                return cls(columns.spread(normal.upper.conj()), basis, normal.upper)
        Q, R = cast("tuple[Complexes, Complexes]", linalg.qr(basis, mode="economic"))
        return cls(columns.spread(R), Q, None)

    def down(self, p: Complexes) -> Complexes:
        """Q^H p, shape (r,), complex128, for p of shape (M,)."""
        q = adjoint(self.basis, p)
        if self.upper is None:
            return q
        q, _ = lapack.ztrtrs(self.upper, q.conj(), trans=2)
        return cast("Complexes", np.conj(q))


@dataclass(frozen=True, eq=False)
class Normal:
    """The Cholesky factor of the smaller Gram matrix: U^H U = conj(B B^H) if M <= N, else conj(B^H B).

    reciprocal_condition: LAPACK's estimate for the Gram matrix; 0 where it is not positive definite.
    """

    upper: Complexes
    reciprocal_condition: float

    @classmethod
    def of(cls, B: Complexes) -> Normal:
        """The factor, in the precision of B; shape (M, N)."""
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
        """(B B^H)^-1 y, or (B^H B)^-1 y, complex128, as good as the factor is."""
        size = float(np.abs(y).max()) or 1.0  # so that single precision can hold it
        potrs = lapack.cpotrs if self.upper.dtype == np.complex64 else lapack.zpotrs
        x, _ = potrs(self.upper, (y.conj() / size).astype(self.upper.dtype))
        return cast("Complexes", np.conj(x.ravel()) * np.complex128(size))

    def pseudo_inverse(self, B: Complexes, p: Complexes) -> Complexes:
        """B^+ p, shape (N,), complex128, as good as the factor is."""
        M, N = B.shape
        g = adjoint(B, self.solve(p)) if M <= N else self.solve(adjoint(B, p))
        return g.astype(np.complex128, copy=False)


def refine(B: Complexes, normal: Normal, p: Complexes) -> Complexes | None:
    """B^+ p by steps of refinement, shape (N,); None where the factor is not good enough for them."""
    eps = float(np.finfo(B.dtype).eps)
    g = normal.pseudo_inverse(B, p)
    first = last = float(np.linalg.norm(g))
    for step in range(STEPS if first else 0):
        d = normal.pseudo_inverse(B, p - B @ g.astype(B.dtype, copy=False))
        length = float(np.linalg.norm(d))
        if not step and not length < SHRUNK * first:
            return None
        if not length < last / 2.0:  # what is left is rounding
            break
        g += d
        if length**2 <= eps * first * last:  # as long as the next one would be
            break
        last = length
    return g


def adjoint(B: Complexes, y: Complexes) -> Complexes:
    """B^H y, shape (N,), in the precision of B."""
    return np.conj(y.conj().astype(B.dtype, copy=False) @ B)


def rounding_share(B: Complexes) -> float:
    """The share of the largest singular value below which rounding may have made them.

    max(M, N) eps; in single precision at least that of the phases, 6e-8 k r and more.
    """
    least = PHASES if B.dtype == np.complex64 else 0.0
    return max(least, float(max(1, *B.shape) * np.finfo(B.dtype).eps))


def scale_matrix(B: Complexes) -> tuple[Complexes, int]:
    """B 2^shift, contiguous, so that its square suits single precision; and the shift."""
    B = np.ascontiguousarray(B)
    parts = B.view(B.real.dtype)
    largest = float(max(parts.max(initial=0.0), -parts.min(initial=0.0)))
    if not largest or 1e-4 < largest < 1e6:
        return B, 0
    shift = -math.frexp(largest)[1]
    return np.ldexp(parts, shift).view(B.dtype), shift
