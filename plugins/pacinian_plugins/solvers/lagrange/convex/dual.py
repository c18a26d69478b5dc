"""The Lagrange dual of least squares under limits on gains, on their power and on sound pressures.

    minimise  sum_k w_k |r_k|^2 / 2 + mu/2 ||h||^2   where  r = p - A h,
    subject to  |h_n| <= 1,  ||h||^2 <= P,  |r_k| <= q_k  (infinite: near, 0: exact, else: quiet),

has the dual, with one complex multiplier y_k per row and x = A^H y,

    maximise  D(y) = Re(y^H p) - sum_k C(y_k; w_k, q_k) - min_(nu >= 0) [sum_n C(x_n; mu + nu, 1) + nu P/2],
    C(x; w, q) = max over |h| <= q of Re(x^* h) - w |h|^2 / 2.

Its gradient F(y) = p - r(y) - A h(x) has r and h where those maxima are: at any y both are within
their limits, and D(y) is a lower bound of the minimum. Where strength s is to be the largest instead,
r = s c - A h; then it is -s that is minimised, and Re(y^H c) = 1.
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

MIN_MU = 1e-15  # least mu where strength is asked for
BEYOND = 1e6  # ||h||, relative to ||p|| / ||a row of A||


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
    along: Complexes | None = None  # c, (R,)

    @classmethod
    def of(
        cls, A: Complexes, rows: Constraints, mu: float, gain: bool, power: float | None
    ) -> Dual:
        """gain: whether |h_n| <= 1. power: P, None for no limit."""
        N = A.shape[1]
        top = np.full(N, 1.0 if gain else np.inf)
        whole = math.inf if power is None else power
        return cls(A, rows, np.full(N, float(mu)), top, whole if whole < top @ top else math.inf)

    @property
    def mu(self) -> float:
        """[Pa^2]."""
        return float(self.weight[0])

    @property
    def most(self) -> float:
        """The most power that the limits allow; infinite without any."""
        return min(self.power, float(self.limit @ self.limit))

    def pull(self, y: Complexes) -> Complexes:
        """A^H y, (N,)."""
        x = np.empty(self.A.shape[1], np.complex128)
        kernels.adjoint(self.A, y, x)
        return x

    def make(self, h: Complexes) -> Complexes:
        """A h, (R,) [Pa]."""
        made = np.empty(self.A.shape[0], np.complex128)
        kernels.forward(self.A, h, made)
        return made

    def at(self, y: Complexes, x: Complexes | None = None) -> Point:
        """Evaluate at y; x: A^H y if known."""
        x = self.pull(y) if x is None else x
        nu = kernels.lift(x, self.weight, self.limit, self.power) if self.power < math.inf else 0.0
        h, r = np.empty_like(x), np.empty_like(y)
        cost = kernels.clip(x, self.weight, nu, self.limit, h)
        cost += kernels.clip(y, self.rows.weight, 0.0, self.rows.limit, r)
        if nu > 0.0:
            cost += nu * self.power / 2.0
        return Point(y, x, h, r, nu, float(np.vdot(y, self.rows.p).real) - cost)

    def slope(self, point: Point, made: Complexes, s: float) -> Complexes:
        """F(y), (R,) [Pa], where A h and the strength are known."""
        F = self.rows.p - point.r - made
        return F if self.along is None else F + s * self.along

    def smoothed(self, rows: float, gains: float) -> Dual:
        """With weights on quiet rows, and on gains if strength is asked for, that cost at most so much."""
        smooth = replace(self, rows=self.rows.smoothed(rows))
        if self.along is None:
            return smooth
        return replace(
            smooth, weight=np.full_like(self.weight, max(2.0 * gains / self.most, MIN_MU))
        )

    def spare(self, y: Complexes) -> float:
        """By how much D(y) may exceed the bound for the limits as given, and no weights on limited rows."""
        rows, k = self.rows, self.rows.quiet
        gains = 0.0 if self.along is None else self.mu * self.most / 2.0
        if not k.any():
            return gains
        q = rows.limit[k]
        return gains + float(np.abs(y[k]) @ rows.slack[k] + rows.weight[k] @ (q * q) / 2.0)

    def impossible(self, y: Complexes, scale: float) -> bool:
        """Whether y proves that no gains keep the rows' limits (Farkas): they pull more than gains can give.

        scale: the mean square of A's rows. Gains that are `BEYOND` what a row needs do not count.
        """
        rows = self.rows
        hard = np.where(rows.soft, 0.0, y)
        x = np.abs(self.pull(hard))
        q = np.where(rows.soft, 0.0, rows.limit + rows.slack)
        asked = float(np.vdot(hard, rows.p).real - np.abs(hard) @ q)
        if asked <= 0.0:
            return False
        most = min(self.most, BEYOND**2 * float(np.vdot(rows.p, rows.p).real) / max(scale, 1e-300))
        reach = math.sqrt(most) * float(np.linalg.norm(x))
        if self.limit[0] < math.inf:
            reach = min(reach, float(self.limit @ x))
        return asked > reach
