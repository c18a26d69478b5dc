"""The Lagrange dual of least squares under |h_n| <= 1, and its semismooth Newton steps.

    minimise  1/2 ||p - B h||^2 + mu/2 ||h||^2   subject to |h_n| <= 1

has the dual, with one complex multiplier y_m per sample and x = B^H y,

    maximise  D(y) = Re(y^H p) - 1/2 ||y||^2 - sum_n c(x_n),
    c(x) = |x|^2 / (2 mu) where |x| <= mu, else |x| - mu/2,

whose stationarity F(y) = p - y - B h(x) = 0 gives h = x/mu where |x| <= mu, else x/|x|: the limit
cannot be broken, and y is the residual. F changes in a direction d by -(H d - K conj(d)),
H = I + B diag(w1) B^H, K = B diag(w2) B^T, with w1 = 1/mu, w2 = 0 for free transducers and
w1 = 1/(2|x|), w2 = (x/|x|)^2 / (2|x|) for those at their limit, which move only along their phase:
a 2M x 2M real positive definite system, or an M x M complex one where none is at its limit.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from scipy import linalg

from pacinian.acoustics.compiled import compiled

if TYPE_CHECKING:
    import pacinian as pc
    from pacinian.solving.factor import Factor
    from pacinian.types import Complexes, Reals

ARMIJO = 1e-4  # share of the promised ascent that a step must bring
FLATTER = 0.9  # share of ||F|| that will do instead: near the top D rounds before F does
CLOSE = 1e-4  # relative gap at which a step that finds nothing better means the top
SHORTEST = 1e-4  # of a step
FIRST_ORDER, LOOK = 4000, 25  # gradient steps at most, and between two looks at the gap
NEAR = (1e-3, 1e-5)  # relative gaps at which Newton steps take over
ENOUGH = {np.dtype(np.complex64): 3e-6, np.dtype(np.complex128): 1e-10}  # ||F|| / ||p|| to stop at


class Point(NamedTuple):
    """The dual at one y."""

    y: Complexes  # (M,) [Pa]
    size: Reals  # (N,) |B^H y|
    h: Complexes  # (N,), |h| <= 1
    made: Complexes  # (M,) B h [Pa]
    value: float  # D(y) [Pa^2]


class Climb(NamedTuple):
    """Where Newton steps ended."""

    point: Point
    steps: int
    done: bool  # at the top, as far as the precision goes
    late: bool


@compiled("f8(c8[::1], f8, f4[::1], c8[::1])", "f8(c16[::1], f8, f8[::1], c16[::1])")
def saturate(x: Complexes, mu: float, size: Reals, h: Complexes) -> float:
    """Write |x| and h(x), (N,); return the sum of c(x_n)."""
    cost = 0.0
    for n in range(x.size):
        re, im = np.float64(x[n].real), np.float64(x[n].imag)  # the ascent is measured by c
        r = np.sqrt(re * re + im * im)
        top = max(r, mu)
        h[n] = complex(re / top, im / top)
        size[n] = r
        cost += r * r / (2.0 * mu) if r <= mu else r - mu / 2.0
    return cost


@dataclass(frozen=True, eq=False)
class Dual:
    """The dual for one B, (M, N), its Gram matrix, and the Cholesky factor of B B^H + mu I."""

    B: Complexes
    gram: Complexes
    factor: Factor
    mu: float

    def at(self, y: Complexes, p: Complexes) -> Point:
        """Evaluate at y."""
        x = (y.conj().astype(self.B.dtype) @ self.B).conj()
        size, h = np.empty(len(x), dtype=x.real.dtype), np.empty_like(x)
        cost = saturate(x, self.mu, size, h)
        made = (self.B @ h).astype(np.complex128)
        return Point(y, size, h, made, float(np.vdot(y, p).real - np.vdot(y, y).real / 2.0 - cost))

    def primal(self, point: Point, p: Complexes) -> float:
        """1/2 ||p - B h||^2 + mu/2 ||h||^2 [Pa^2]; not below D anywhere."""
        rest = p - point.made
        power = float(np.vdot(point.h, point.h).real)
        return (float(np.vdot(rest, rest).real) + self.mu * power) / 2.0

    def unlimited(self, p: Complexes) -> Complexes:
        """The y that solves it if nothing reaches the limit: the regularised pseudo-inverse."""
        return self.mu * self.factor.solve(p)

    def direction(self, point: Point, F: Complexes) -> Complexes:
        """The Newton direction d, of H d - K conj(d) = F."""
        held = point.size > self.mu
        if not held.any():
            return self.unlimited(F)
        M, single = len(F), self.B.real.dtype
        half = 0.5 / point.size[held]
        Bs = self.B[:, held]
        if held.mean() <= 0.5:  # take those at their limit out of B B^H / mu
            H = self.gram / self.mu - (Bs * (1.0 / self.mu - half).astype(single)) @ Bs.conj().T
        else:
            Bf = self.B[:, ~held]
            H = (Bf @ Bf.conj().T) / self.mu + (Bs * half.astype(single)) @ Bs.conj().T
        K = (Bs * (point.h[held] ** 2 * half).astype(Bs.dtype)) @ Bs.T
        A = np.empty((2 * M, 2 * M))
        A[:M, :M], A[:M, M:] = H.real - K.real, -H.imag - K.imag
        A[M:, :M], A[M:, M:] = H.imag - K.imag, H.real + K.real
        A[np.diag_indices(2 * M)] += 1.0
        b = np.concatenate([F.real, F.imag])
        try:
            d = linalg.cho_solve(linalg.cho_factor(A, lower=True), b)
        except linalg.LinAlgError:  # the products' rounding in single precision
            d = linalg.lstsq(A, b)[0]
        return d[:M] + 1j * d[M:]

    def top(self, start: Point, p: Complexes, steps: int, budget: pc.Budget) -> Climb:
        """The optimum from `start`: Newton steps, and where they overshoot, gradient steps between."""
        best = self.climb(start, p, steps, budget)
        total = best.steps
        for near in NEAR:
            if best.done or best.late:
                break
            found = self.approach(best.point.h, p, near, budget)
            end = self.climb(self.at(found.y, p), p, steps, budget)
            total += end.steps
            best = end._replace(point=self.better(found, end.point, p))
        return best._replace(steps=total)

    def climb(self, point: Point, p: Complexes, steps: int, budget: pc.Budget) -> Climb:
        """Newton steps from `point`, until F vanishes, the precision is used up, or no more are left."""
        enough = ENOUGH[self.B.dtype] * float(np.linalg.norm(p))
        for step in range(steps):
            F = p - point.y - point.made
            if np.linalg.norm(F) <= enough:
                return Climb(point, step, True, False)
            if budget.spent:
                return Climb(point, step, False, True)
            ahead = self._forward(point, p, F)
            if ahead is None:
                best = self.primal(point, p)
                return Climb(point, step, best - point.value <= CLOSE * best, False)
            point = ahead
        return Climb(point, steps, False, False)

    def approach(self, h: Complexes, p: Complexes, near: float, budget: pc.Budget) -> Point:
        """Accelerated projected gradient steps on the primal from h, to a relative gap of `near`.

        Where targets are out of reach Newton steps from afar overshoot, but which transducers end at
        their limit is soon found this way (FISTA with restarts: Beck and Teboulle 2009, O'Donoghue
        and Candes 2015). The point has the gains found, and the y and D that they prove.
        """
        steepest = float(np.linalg.eigvalsh(self.gram)[-1]) + self.mu  # Lipschitz constant
        ahead, t, step = h, 1.0, 0
        while True:
            step += 1
            rest = (p - self.B @ ahead).astype(self.B.dtype)
            new = ahead + ((rest.conj() @ self.B).conj() - self.mu * ahead) / steepest
            new = (new / np.maximum(np.abs(new), 1.0)).astype(self.B.dtype)
            if np.vdot(ahead - new, new - h).real > 0.0:  # past the bottom: start anew
                t = 1.0
            following = (1.0 + math.sqrt(1.0 + 4.0 * t * t)) / 2.0
            ahead, h, t = new + (t - 1.0) / following * (new - h), new, following
            if step % LOOK == 0 or budget.spent:
                made = (self.B @ h).astype(np.complex128)
                point = self.at(p - made, p)._replace(h=h, made=made)
                best = self.primal(point, p)
                if best - point.value <= near * best or budget.spent or step >= FIRST_ORDER:
                    return point

    def better(self, a: Point, b: Point, p: Complexes) -> Point:
        """The gains of the lower objective, with the higher of both bounds."""
        point = a if self.primal(a, p) < self.primal(b, p) else b
        return point._replace(value=max(a.value, b.value))

    def _forward(self, point: Point, p: Complexes, F: Complexes) -> Point | None:
        """The next point: higher, or with a smaller gradient F; None where the precision is used up."""
        d = self.direction(point, F)
        promise = ARMIJO * float(np.vdot(d, F).real)
        steep = float(np.linalg.norm(F))
        length = 1.0
        while length > SHORTEST:
            ahead = self.at(point.y + length * d, p)
            if ahead.value > point.value + length * promise:
                return ahead
            if float(np.linalg.norm(p - ahead.y - ahead.made)) < FLATTER * steep:
                return ahead
            length /= 2.0
        return None
