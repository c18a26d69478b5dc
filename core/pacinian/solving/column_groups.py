"""Merge equal columns of B, which mirrored or coincident transducers have, so that each group shares one gain."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from pacinian.types import Complexes, Floats, Indices

PROJECTIONS = 4  # number of random projections by which columns are compared
# Window in the order of the first projection within which equal columns are sought.
SEARCH_WINDOW = 8


@dataclass(frozen=True, eq=False)
class ColumnGroups:
    """An orthonormal S, (N, r), with B = (B S) S^H; g = S h divides each h equally among the columns of its group.

    kept: one column of each group, ascending, (r,). group: group of each column, (N,); -1 for a column of zeros, which
    is left out. root: square root of the number of columns in each group, (r,).
    """

    kept: Indices
    group: Indices
    root: Floats

    @classmethod
    def of(cls, B: Complexes, tolerance: float) -> ColumnGroups:
        """Group the columns of B, (M, N), that differ by at most `tolerance` times the largest."""
        W = np.random.default_rng(0).normal(size=(PROJECTIONS, len(B)))
        P = W.astype(B.dtype) @ B
        F = np.concatenate([P.real, P.imag]).astype(np.float64)  # (2 PROJECTIONS, N)
        size = np.abs(F).max(axis=0, initial=0.0)
        tolerance *= float(size.max(initial=0.0))
        order = np.argsort(F[0], kind="stable")
        first = order[_first(F[:, order], tolerance)]
        group = np.empty_like(order)
        group[order] = first
        group[size <= tolerance] = -1
        kept, place, count = np.unique(group, return_inverse=True, return_counts=True)
        zeros = int(kept.size > 0 and kept[0] < 0)
        return cls(kept[zeros:], place - zeros, np.sqrt(count[zeros:]))

    @property
    def trivial(self) -> bool:
        """Whether all columns differ, so that S is the identity."""
        return len(self.kept) == len(self.group)

    def merge(self, B: Complexes, axis: int = 1) -> Complexes:
        """Return B S, shape (M, r); for axis 0, S^H B, to merge equal rows."""
        if self.trivial:
            return B
        root = self.root.astype(B.real.dtype)
        return np.take(B, self.kept, axis=axis) * (root if axis else root[:, None])

    def gather(self, g: Complexes) -> Complexes:
        """Return S^H g, shape (r,), complex128."""
        total = np.zeros(len(self.kept) + 1, dtype=np.complex128)  # the last is for zeros
        np.add.at(total, self.group, g)
        return total[:-1] / self.root

    def spread(self, h: Complexes) -> Complexes:
        """Return S h, shape (N,), for h of shape (r,); for h of shape (K, r), apply S to each row, (K, N)."""
        h = h / self.root
        return np.concatenate([h, np.zeros_like(h, shape=(*h.shape[:-1], 1))], axis=-1)[
            ..., self.group
        ]


def _first(F: Floats, tolerance: float) -> Indices:
    """Return for each column of F, sorted by its first row, the index of the first equal column, (N,)."""
    index = np.arange(F.shape[1])
    first = index.copy()
    for s in range(1, min(len(index), SEARCH_WINDOW)):
        near = np.abs(F[:, s:] - F[:, :-s]).max(axis=0) <= tolerance
        near &= first[s:] == index[s:]
        first[s:][near] = index[:-s][near]
    while (first != first[first]).any():
        first = first[first]
    apart = np.abs(F - F[:, first]).max(axis=0, initial=0.0) > tolerance  # far ends of chains
    return np.where(apart, index, first)
