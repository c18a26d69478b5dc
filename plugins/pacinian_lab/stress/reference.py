"""The smallest residual that any gains leave, in double precision and without a solver.

F(g) = ||p - B g||^2 + mu ||g||^2     over all gains, or those of |g_n| <= limit
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from pacinian.types import Complexes, Floats

GAP = 0.01  # relative, between the value found and the proven bound
CLOSED = 1e-14  # gap that double precision can resolve, relative to ||p||^2
# maximum number of gradient steps; steps between two checks of the gap
STEPS, STEPS_PER_CHECK = 20_000, 50


@dataclass(frozen=True, eq=False)
class Reference:
    """B = U diag(s) Vh, (M, N), by its singular value decomposition."""

    U: Complexes
    s: Floats
    Vh: Complexes

    @classmethod
    def of(cls, B: Complexes) -> Reference:
        """Decompose B."""
        return cls(*np.linalg.svd(B, full_matrices=False))

    def best(
        self, p: Complexes, mu: float, rounding: float, limit: float, start: Complexes
    ) -> float:
        """Return a lower bound of ||p - B g||^2 + rounding ||g||^2 [Pa^2] over all gains.

        p: targets, (M,). The best gains minimise F for mu + rounding. Within the limit, the bound is a closed form.
        If the best gains reach the limit, mu ||g||^2 is included, and the bound is within 1 % of the minimum of F
        (unless `STEPS` steps are not enough). It is found by accelerated projected gradient steps with restarts, from
        the gains `start`, (N,). They stop by the Lagrange dual, which bounds F / 2 from below at any y: Re(y^H p) -
        ||y||^2 / 2 - sum_n c(x_n) for x = B^H y, with c(x) = |x|^2 / (2 mu) where |x| <= mu limit, else limit |x| -
        mu limit^2 / 2.
        """
        c = self.U.conj().T @ p
        lost = float(np.linalg.norm(p - self.U @ c)) ** 2  # outside the range of B
        weight = self.s**2 + mu + rounding
        share = np.divide(self.s, weight, out=np.zeros_like(weight), where=weight > 0.0)
        if not np.abs(self.Vh.conj().T @ (share * c)).max() > limit:
            left = (1.0 - self.s * share) ** 2 + rounding * share**2
            return lost + float(left @ np.abs(c) ** 2)
        return lost + limit**2 * self._compute_bound(c / limit, mu + rounding, start / limit)

    def _compute_bound(self, c: Complexes, mu: float, start: Complexes) -> float:
        """Return the same bound for |h_n| <= 1 and p = U c."""
        B = self.s[:, None] * self.Vh
        Bh = B.conj().T.copy()
        steepest = float(self.s[0]) ** 2 + mu
        h = start / np.maximum(np.abs(start), 1.0)
        ahead, t, bound = h, 1.0, 0.0
        for step in range(STEPS):
            if step % STEPS_PER_CHECK == 0:
                y = c - B @ h
                found = float(np.vdot(y, y).real + mu * np.vdot(h, h).real)
                bound = max(bound, 2.0 * _dual(c, y, np.abs(Bh @ y), mu))
                if found - bound <= GAP * found + CLOSED * float(np.vdot(c, c).real):
                    break
            new = ahead + (Bh @ (c - B @ ahead) - mu * ahead) / steepest
            new /= np.maximum(np.abs(new), 1.0)
            if np.vdot(ahead - new, new - h).real > 0.0:  # overshoot: restart the momentum
                t = 1.0
            following = (1.0 + math.sqrt(1.0 + 4.0 * t * t)) / 2.0
            ahead, h, t = new + (t - 1.0) / following * (new - h), new, following
        return bound


def _dual(p: Complexes, y: Complexes, x: Floats, mu: float) -> float:
    m = np.minimum(x, mu)
    cost = m / (mu or 1.0) * (x - m / 2.0) if mu else x
    return float(np.vdot(y, p).real - np.vdot(y, y).real / 2.0 - cost.sum())
