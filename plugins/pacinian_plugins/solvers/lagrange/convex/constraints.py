"""Requirements on the sound pressures, row by row: near, exact or quiet."""

from __future__ import annotations

import functools
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from pacinian.types import Complexes, Flags, Floats

QUIET_MARGIN = 2e-6  # relative amount by which quiet limits are tightened, and may then be exceeded
INERT = 1e-9  # initial cost of the weights of quiet rows, relative to ||p||^2
# Relative error ||p - A h|| / ||p|| of the exact rows up to which they count as met.
MAX_EXACT_ERROR = 3e-6


@dataclass(frozen=True, eq=False)
class Constraints:
    """Rows r = p - A h that cost weight |r|^2 / 2 and must satisfy |r| <= limit.

    p: (R,) [Pa]. weight: (R,); 1, or a smoothing weight for rows with a limit.
    limit: (R,) [Pa]; infinite for near rows, 0 for exact rows, the loudest sound pressure allowed for quiet rows.
    slack: (R,) [Pa], excess over the limit that is tolerated.
    """

    p: Complexes
    weight: Floats
    limit: Floats
    slack: Floats

    @classmethod
    def of(cls, p: Complexes, exact: Flags | None, quiet: Floats | None) -> Constraints:
        """Build the rows of M samples p, some of them exact, followed by K quiet points."""
        q = np.zeros(0) if quiet is None else np.asarray(quiet, np.float64)
        hard = np.zeros(len(p), np.bool_) if exact is None else np.asarray(exact, np.bool_)
        size = float(np.linalg.norm(p[hard] if hard.any() else p))
        each = MAX_EXACT_ERROR * size / np.sqrt(max(1, int(hard.sum())))
        rows = cls(
            np.concatenate([p, np.zeros(len(q))]).astype(np.complex128),
            np.concatenate([np.ones(len(p)), np.ones(len(q))]),
            np.concatenate([np.where(hard, 0.0, np.inf), (1.0 - QUIET_MARGIN) * q]),
            np.concatenate([np.where(hard, each, 0.0), np.where(q > 0.0, QUIET_MARGIN * q, each)]),
        )
        return rows.smooth(INERT * float(np.vdot(p, p).real))

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
        """Return the factor on the gains, at most 1, that brings the quiet rows within their limits."""
        loud = np.abs(made[self.quiet]) / (self.limit + self.slack)[self.quiet]
        return 1.0 / max(1.0, float(loud.max(initial=0.0)) * (1.0 + 1e-12))

    def violation(self, r: Complexes) -> Floats:
        """Return the excess of |r| over the given limits, (R,) [Pa]."""
        most = np.where(self.quiet, self.limit + self.slack, self.limit)
        beyond: Floats = np.maximum(np.abs(r) - most, 0.0, dtype=np.float64)
        return beyond

    def smooth(self, cost: float) -> Constraints:
        """Return a copy whose quiet rows have smoothing weights that cost at most `cost` [Pa^2] in total."""
        if not self.quiet.any():
            return self
        weight, q = self.weight.copy(), self.limit[self.quiet]
        weight[self.quiet] = np.maximum(2.0 * cost / (len(q) * q * q), 1e-200)
        return replace(self, weight=weight)

    def relax(self) -> Constraints:
        """Return a copy whose exact rows are near rows."""
        soft = self.limit == 0.0
        return replace(
            self, limit=np.where(soft, np.inf, self.limit), weight=np.where(soft, 1.0, self.weight)
        )
