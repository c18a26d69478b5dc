"""The Lagrange dual of least squares under limits on gains, on their power and on sound pressures.

    minimise  sum_k w_k |r_k|^2 / 2 + mu/2 ||h||^2   where  r = p - A h,
    subject to  |h_n| <= 1,  ||h||^2 <= P,  |r_k| <= q_k  (infinite: near, 0: exact, else: quiet),

has the dual, with one complex multiplier y_k per row and x = A^H y,

    maximise  D(y) = Re(y^H p) - sum_k C(y_k; w_k, q_k) - min_(nu >= 0) [sum_n C(x_n; mu + nu, 1) + nu P/2],
    C(x; w, q) = max over |h| <= q of Re(x^* h) - w |h|^2 / 2.

Its gradient is F(y) = p - r(y) - A h(x), where r and h attain these maxima. At any y, both are within
their limits, and D(y) is a lower bound of the minimum. If the strength s is maximised instead,
r = s c - A h, the objective is -s, and Re(y^H c) = 1.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from pacinian_plugins.native import lagrange as kernels

if TYPE_CHECKING:
    from pacinian.types import Complexes, Floats
    from pacinian_plugins.solvers.lagrange.convex.constraints import Constraints

MIN_MU = 1e-15  # least mu when the strength is maximised [Pa^2]
# ||h||, relative to ||p|| / ||a row of A||, beyond which gains do not count.
MAX_RELATIVE_GAINS = 1e6


class Point(NamedTuple):
    """The dual at one y."""

    y: Complexes  # (R,) [Pa]
    x: Complexes  # (N,) A^H y
    h: Complexes  # (N,), within the limits
    r: Complexes  # (R,) [Pa], within the limits
    nu: float  # [Pa^2]
    value: float  # D(y) [Pa^2]


@dataclass(frozen=True, eq=False)
class Dual:
    """The dual for A, (R, N) [Pa]; weight: mu, (N,) [Pa^2]; limit: of gains, (N,)."""

    A: Complexes
    rows: Constraints
    weight: Floats
    limit: Floats
    power: float
    along: Complexes | None = None  # c, (R,), when the strength is maximised

    @classmethod
    def of(
        cls, A: Complexes, rows: Constraints, mu: float, gain: bool, power: float | None
    ) -> Dual:
        """Build the dual. gain: whether |h_n| <= 1. power: P, None for no limit."""
        N = A.shape[1]
        top = np.full(N, 1.0 if gain else np.inf)
        whole = math.inf if power is None else power
        return cls(A, rows, np.full(N, float(mu)), top, whole if whole < top @ top else math.inf)

    @property
    def mu(self) -> float:
        """Regularisation [Pa^2]."""
        return float(self.weight[0])

    @property
    def most(self) -> float:
        """Largest power within the limits; infinite if there are none."""
        return min(self.power, float(self.limit @ self.limit))

    def pull(self, y: Complexes) -> Complexes:
        """Return A^H y, (N,)."""
        x = np.empty(self.A.shape[1], np.complex128)
        kernels.adjoint(self.A, y, x)
        return x

    def make(self, h: Complexes) -> Complexes:
        """Return A h, (R,) [Pa]."""
        made = np.empty(self.A.shape[0], np.complex128)
        kernels.forward(self.A, h, made)
        return made

    def at(self, y: Complexes, x: Complexes | None = None) -> Point:
        """Evaluate the dual at y. x: A^H y if known."""
        x = self.pull(y) if x is None else x
        nu = kernels.lift(x, self.weight, self.limit, self.power) if self.power < math.inf else 0.0
        h, r = np.empty_like(x), np.empty_like(y)
        cost = kernels.clip(x, self.weight, nu, self.limit, h)
        cost += kernels.clip(y, self.rows.weight, 0.0, self.rows.limit, r)
        if nu > 0.0:
            cost += nu * self.power / 2.0
        return Point(y, x, h, r, nu, float(np.vdot(y, self.rows.p).real) - cost)

    def slope(self, point: Point, made: Complexes, s: float) -> Complexes:
        """Return F(y), (R,) [Pa]. made: A h, (R,) [Pa]. s: strength."""
        F = self.rows.p - point.r - made
        return F if self.along is None else F + s * self.along

    def smooth(self, rows: float, gains: float) -> Dual:
        """Return a smoother dual. rows, gains: most that the weights of quiet rows, and of gains, may cost [Pa^2].

        The gains are smoothed only when the strength is maximised.
        """
        smooth = replace(self, rows=self.rows.smooth(rows))
        if self.along is None:
            return smooth
        return replace(
            smooth, weight=np.full_like(self.weight, max(2.0 * gains / self.most, MIN_MU))
        )

    def spare(self, y: Complexes) -> float:
        """Return by how much D(y) may exceed the bound of the problem with the given limits and no smoothing."""
        rows, k = self.rows, self.rows.quiet
        gains = 0.0 if self.along is None else self.mu * self.most / 2.0
        if not k.any():
            return gains
        q = rows.limit[k]
        return gains + float(np.abs(y[k]) @ rows.slack[k] + rows.weight[k] @ (q * q) / 2.0)

    def impossible(self, y: Complexes, scale: float) -> bool:
        """Return whether y proves that no gains keep the limits of the rows (Farkas' lemma).

        scale: mean square of the rows of A. Gains more than `MAX_RELATIVE_GAINS` times what a row needs do not count.
        """
        rows = self.rows
        hard = np.where(rows.soft, 0.0, y)
        x = np.abs(self.pull(hard))
        q = np.where(rows.soft, 0.0, rows.limit + rows.slack)
        asked = float(np.vdot(hard, rows.p).real - np.abs(hard) @ q)
        if asked <= 0.0:
            return False
        most = min(
            self.most,
            MAX_RELATIVE_GAINS**2 * float(np.vdot(rows.p, rows.p).real) / max(scale, 1e-300),
        )
        reach = math.sqrt(most) * float(np.linalg.norm(x))
        if self.limit[0] < math.inf:
            reach = min(reach, float(self.limit @ x))
        return asked > reach
