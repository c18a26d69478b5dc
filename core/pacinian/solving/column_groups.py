"""Equal columns of B, as mirrored or coincident transducers have them: each group can share one gain."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from pacinian.types import Complexes, Floats, Indices

PROJECTIONS = 4  # random ones, in which columns are equal that are equal, and hardly any others
NEIGHBOURS = 8  # in order of one of them, among which equal columns are sought


@dataclass(frozen=True, eq=False)
class ColumnGroups:
    """Orthonormal S, (N, r), with B = (B S) S^H: g = S h gives the columns of a group equal shares.

    kept: one column of each group, ascending, (r,). group: which group each column is in, (N,), -1 for
    a column of zeros, which is left out. root: sqrt(columns in the group), (r,).
    """

    kept: Indices
    group: Indices
    root: Floats

    @classmethod
    def of(cls, B: Complexes, tolerance: float) -> ColumnGroups:
        """Of columns that differ by no more than `tolerance` times the largest. B: (M, N)."""
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
        """B S, shape (M, r); for axis 0, S^H B, of a B whose rows are equal."""
        if self.trivial:
            return B
        root = self.root.astype(B.real.dtype)
        return np.take(B, self.kept, axis=axis) * (root if axis else root[:, None])

    def gather(self, g: Complexes) -> Complexes:
        """S^H g, shape (r,), complex128."""
        total = np.zeros(len(self.kept) + 1, dtype=np.complex128)  # the last one is for zeros
        np.add.at(total, self.group, g)
        return total[:-1] / self.root

    def spread(self, h: Complexes) -> Complexes:
        """S h, shape (N,), for h of shape (r,); or of each row, (K, N), for (K, r)."""
        h = h / self.root
        return np.concatenate([h, np.zeros_like(h, shape=(*h.shape[:-1], 1))], axis=-1)[
            ..., self.group
        ]


def _first(F: Floats, tolerance: float) -> Indices:
    """For each column of F, sorted by its first row, the first one that it is equal to; shape (N,)."""
    index = np.arange(F.shape[1])
    first = index.copy()
    for s in range(1, min(len(index), NEIGHBOURS)):
        near = np.abs(F[:, s:] - F[:, :-s]).max(axis=0) <= tolerance
        near &= first[s:] == index[s:]
        first[s:][near] = index[:-s][near]
    while (first != first[first]).any():
        first = first[first]
    apart = np.abs(F - F[:, first]).max(axis=0, initial=0.0) > tolerance  # the far end of a chain
    return np.where(apart, index, first)
