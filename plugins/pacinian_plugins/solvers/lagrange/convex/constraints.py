"""What is asked of the sound pressures, row by row: to be near, to be exact, to be quiet."""

from __future__ import annotations

import functools
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from pacinian.types import Complexes, Flags, Floats

MARGIN = 2e-6  # quiet limits are solved for with this much to spare, and may be missed by as much
INERT = 1e-9  # what the weights of quiet rows cost at first, relative to ||p||^2
EXACT = 3e-6  # ||p - A h|| of the exact rows that counts as none, relative to their ||p||


@dataclass(frozen=True, eq=False)
class Constraints:
    """Rows r = p - A h that cost weight |r|^2 / 2 and have |r| <= limit.

    p: (R,) [Pa]. weight: (R,); 1, or what makes the dual of limited rows smooth.
    limit: (R,) [Pa]; infinite where near will do, 0 where exact, else how loud it may be.
    slack: (R,) [Pa], what is allowed beyond the limit.
    """

    p: Complexes
    weight: Floats
    limit: Floats
    slack: Floats

    @classmethod
    def of(cls, p: Complexes, exact: Flags | None, quiet: Floats | None) -> Constraints:
        """Rows of M samples p, some of them exact, then of K quiet points."""
        q = np.zeros(0) if quiet is None else np.asarray(quiet, np.float64)
        hard = np.zeros(len(p), np.bool_) if exact is None else np.asarray(exact, np.bool_)
        size = float(np.linalg.norm(p[hard] if hard.any() else p))
        each = EXACT * size / np.sqrt(max(1, int(hard.sum())))
        rows = cls(
            np.concatenate([p, np.zeros(len(q))]).astype(np.complex128),
            np.concatenate([np.ones(len(p)), np.ones(len(q))]),
            np.concatenate([np.where(hard, 0.0, np.inf), (1.0 - MARGIN) * q]),
            np.concatenate([np.where(hard, each, 0.0), np.where(q > 0.0, MARGIN * q, each)]),
        )
        return rows.smoothed(INERT * float(np.vdot(p, p).real))

    @functools.cached_property
    def soft(self) -> Flags:
        """Rows without a limit, (R,)."""
        return np.isinf(self.limit)

    @functools.cached_property
    def quiet(self) -> Flags:
        """Rows with a limit other than 0, (R,)."""
        return ~self.soft & (self.limit > 0.0)

    @functools.cached_property
    def hard(self) -> bool:
        """Whether any row is exact and other than 0."""
        return bool(self.p[self.limit == 0.0].any())

    @functools.cached_property
    def limited(self) -> bool:
        """Whether any row has a limit."""
        return not self.soft.all()

    def shorter(self, made: Complexes) -> float:
        """What gains are to be multiplied by for quiet rows to be quiet enough, at most 1."""
        loud = np.abs(made[self.quiet]) / (self.limit + self.slack)[self.quiet]
        return 1.0 / max(1.0, float(loud.max(initial=0.0)) * (1.0 + 1e-12))

    def violation(self, r: Complexes) -> Floats:
        """By how much |r| exceeds the limits as given, (R,) [Pa]."""
        most = np.where(self.quiet, self.limit + self.slack, self.limit)
        beyond: Floats = np.maximum(np.abs(r) - most, 0.0, dtype=np.float64)
        return beyond

    def smoothed(self, cost: float) -> Constraints:
        """Quiet rows with weights that cost at most `cost` together, which makes the dual smooth."""
        if not self.quiet.any():
            return self
        weight, q = self.weight.copy(), self.limit[self.quiet]
        weight[self.quiet] = np.maximum(2.0 * cost / (len(q) * q * q), 1e-200)
        return replace(self, weight=weight)

    def relaxed(self) -> Constraints:
        """The same without exact rows: to be near them will do."""
        soft = self.limit == 0.0
        return replace(
            self, limit=np.where(soft, np.inf, self.limit), weight=np.where(soft, 1.0, self.weight)
        )
