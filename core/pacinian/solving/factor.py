"""Cholesky factor of the regularised Gram matrix."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, cast

import numpy as np

from pacinian.solving.linalg import lapack

if TYPE_CHECKING:
    from pacinian.types import Complexes


@dataclass(frozen=True, eq=False)
class Factor:
    """The upper Cholesky factor of G + mu I, (M, M), complex128.

    definite: whether the matrix is positive definite, so that the factor exists. Valid until the points move.
    """

    gram: Complexes
    mu: float
    upper: Complexes
    definite: bool

    @classmethod
    def of(cls, gram: Complexes, mu: float, buffer: Complexes | None = None) -> Factor:
        """Factor `gram` + mu I; buffer: (M, M), in Fortran order, to write the factor to."""
        upper = np.empty(gram.shape, np.complex128, order="F") if buffer is None else buffer
        upper[...] = gram
        upper.T.reshape(-1)[:: len(gram) + 1] += mu
        _, info = lapack.zpotrf(upper, clean=0, overwrite_a=1)
        return cls(gram, mu, upper, info == 0)

    @property
    def reciprocal_condition(self) -> float:
        """LAPACK's estimate; 0 if the matrix is not positive definite."""
        if not self.definite:
            return 0.0
        norm = float((np.abs(self.gram).sum(axis=0) + self.mu).max())
        reciprocal, _ = lapack.zpocon(self.upper, norm)
        return float(reciprocal)

    def solve(self, y: Complexes) -> Complexes:
        """Return (B B^H + mu I)^-1 y, for y of shape (M,) or (M, K)."""
        x, _ = lapack.zpotrs(self.upper, y)
        return cast("Complexes", x.reshape(y.shape))
