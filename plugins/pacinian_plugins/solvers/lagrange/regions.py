"""Least squares under the gain limit for regions: all phases are given, and no Gram matrix is formed.

The samples of a region lie closer together than the array resolves. Therefore B B^H is nearly singular, and its
regularisation mu affects the solution. Squared errors have weight 1, or `QUIET` beside regions. The dual is that of
`convex.dual`: y solves F(y) = p - D y - B h(B^H y) = 0, where D is 1 over the weights. Newton steps find y. Each step
solves (D + B W B^H) d = F by conjugate gradients, with W = dh/dx: 1 / mu in both directions for a gain below its
limit, and 1 / |x| along its phase for a gain at its limit. Each product reads B once.

Every fourth transducer suffices to capture the coupling of the samples. D + B W B^H is computed and factored for these
transducers only, and preconditions the conjugate gradients. This needs 2 to 4 products instead of 30 to 60.

An error d of the sound pressure changes the radiation pressure by 2 |p| d where the target is |p|, but only by d^2
where the target is 0. So a small weight keeps points beside a region quiet, and leaves the region itself unchanged.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy import float32 as f4

import pacinian as pc
from pacinian.solving.buffer_pool import acquire, release
from pacinian.solving.linalg import blas, lapack
from pacinian.solving.solution import AT_LIMIT
from pacinian_plugins.native.lagrange import TILE, bend, deliver, evaluate, within
from pacinian_plugins.solvers.lagrange.evenly import climb
from pacinian_plugins.solvers.lagrange.reference import solve_newton

if TYPE_CHECKING:
    from pacinian.types import Complexes, Floats, Gains, Singles

QUIET = 0.02  # weight of points beside regions
STOP_RESIDUAL = 5e-3  # ||F|| / ||p|| to stop at: a smaller error cannot be felt
INEXACT = 0.1  # residual of a Newton system, relative to ||F||
STRIDE, MAX_SAMPLES = (
    4,
    400,
)  # preconditioner: stride over transducers, and maximum number of samples
STEPS, PASSES = 15, 300  # maximum number of Newton steps, and of conjugate gradients for each
MIN_STEPS = 4  # conjugate gradients taken even without time, so that the next call starts closer
ARMIJO, MIN_STEP = 1e-4, 1e-6  # least share of the expected increase; shortest step
REFINED = 16  # Newton steps in double precision


class Space(NamedTuple):
    """Workspace of the kernels for M samples and N transducers."""

    tile: Singles
    h: Singles  # gains and |x_n|, (3, N)
    planes: Singles  # real and imaginary parts of a vector of M, (2, M rounded up to 4)
    made: Floats  # result of the last kernel, (2, M)

    @classmethod
    def of(cls, M: int, N: int) -> Space:
        """Allocate the workspace for M samples and N transducers."""
        rows = M + -M % 4
        return cls(
            np.zeros((2, rows, TILE), np.float32),
            np.zeros((3, N), np.float32),
            np.zeros((2, rows), np.float32),
            np.zeros((2, M)),
        )


class Nearly:
    """Preconditioner: approximate inverse of D + B W B^H at gains h, from one in four transducers, each weighted 4."""

    def __init__(self, B: Gains, D: Floats, h: Singles, mu: float) -> None:
        size = h[2, ::STRIDE]
        # a gain at its limit can turn but not grow: one of two directions
        weight = np.where(size > mu, 0.5 / np.maximum(size, mu), f4(1.0 / mu))
        some = B[:, ::STRIDE] * np.sqrt(weight * f4(B.shape[1] / len(size)))
        gram = blas.cherk(1.0, some.T, trans=2)  # upper triangle of the conjugate
        gram.ravel("K")[:: len(gram) + 1] += D.astype(f4)
        self._factor, failed = lapack.cpotrf(gram, overwrite_a=True)
        self._fails = bool(failed)

    def times(self, r: Complexes) -> Complexes:
        """Multiply the inverse by r, (M,)."""
        if self._fails:
            return r
        solved, _ = lapack.cpotrs(self._factor, r.conj().astype(np.complex64))
        return np.asarray(solved.conj(), np.complex128)


class Descent:
    """Newton steps on the multipliers y, (M,), from a given start, for targets p, (M,) [Pa per unit limit].

    D: 1 over the weights of the squared errors, (M,).
    """

    def __init__(
        self, B: Gains, p: Complexes, D: Floats, y: Complexes, mu: float, space: Space,
        budget: pc.Budget,
    ) -> None:  # fmt: skip
        self.B, self.p, self.D, self.y, self.mu = B, p, D, y, mu
        self.space, self.budget = space, budget
        self.steps = 0
        self.met = False
        """Whether the steps have converged."""
        self._nearly: Nearly | None = None
        self.cost = 0.0
        """The sum of c(x_n) at y."""

    def run(self) -> None:
        """Take steps until F is small or nothing improves; the gains are in the workspace."""
        size, last = float(np.linalg.norm(self.p)), self.steps + STEPS
        F, value = self._look(self.y)
        while (missed := float(np.linalg.norm(F))) > STOP_RESIDUAL * size:
            if self.steps == last or (self.steps > last - STEPS and self.budget.spent):
                break
            d = self._direction(F, max(INEXACT * missed, STOP_RESIDUAL * size / 2.0))
            slope, step = float(np.vdot(F, d).real), 1.0
            at, before = self.y, value
            while step > MIN_STEP:
                F, value = self._look(at + step * d)
                if value >= before + ARMIJO * step * slope:
                    break
                step /= 2.0
            else:
                self._look(at)
                break
            self.steps += 1
        self.met = missed <= STOP_RESIDUAL * size

    def turn_to(self, p: Complexes) -> Complexes:
        """Continue with other targets, (M,), of the same phases; return the pressures made, (M,)."""
        self.y = self.y * (np.linalg.norm(p) / np.linalg.norm(self.p))
        self.p = p
        self.run()
        return self._copy_made()

    def proof(self) -> tuple[float, float]:
        """Return D(y), and 1/2 sum_m |p - B h|_m^2 / D_m + mu/2 ||h||^2."""
        rest = self.p - self._copy_made()
        dual = float(np.vdot(self.y, self.p).real - np.vdot(self.y, self.D * self.y).real / 2.0)
        power = float((self.space.h[:2].astype(np.float64) ** 2).sum())
        return dual - self.cost, (float(np.vdot(rest, rest / self.D).real) + self.mu * power) / 2.0

    def _look(self, y: Complexes) -> tuple[Complexes, float]:
        """Evaluate y, and store it with its gains; return F and the value D of the dual."""
        space, self.y = self.space, y
        self.cost = evaluate(self.B, self._planes(y), self.mu, space.h, space.made, space.tile)
        Dy = self.D * y
        value = float(np.vdot(y, self.p).real - np.vdot(y, Dy).real / 2.0) - self.cost
        return self.p - Dy - self._copy_made(), value

    def _direction(self, F: Complexes, enough: float) -> Complexes:
        """Solve (D + B W B^H) d = F for d, with a residual of at most `enough`."""
        space = self.space
        if self._nearly is None and len(F) <= MAX_SAMPLES:
            self._nearly = Nearly(self.B, self.D, space.h, self.mu)
        nearly = self._nearly.times if self._nearly else np.copy
        d, r = np.zeros_like(F), F.copy()
        q = nearly(r)
        square = float(np.vdot(r, q).real)
        for done in range(PASSES):
            bend(self.B, self._planes(q), space.h, self.mu, space.made, space.tile)
            Hq = self.D * q + self._copy_made()
            a = square / float(np.vdot(q, Hq).real)
            d += a * q
            r -= a * Hq
            rest = float(np.vdot(r, r).real)
            if rest <= enough * enough or (done >= MIN_STEPS and self.budget.spent):
                break
            z = nearly(r)
            last, square = square, float(np.vdot(r, z).real)
            q = z + (square / last) * q
        return d

    def _planes(self, y: Complexes) -> Singles:
        """Return a vector, (M,), in the layout of the kernels."""
        planes = self.space.planes
        planes[0, : len(y)], planes[1, : len(y)] = y.real, y.imag
        return planes

    def _copy_made(self) -> Complexes:
        """Return the result of the last kernel, (M,)."""
        return np.asarray(self.space.made[0] + 1j * self.space.made[1])


def solve(
    propagator: pc.Propagator, targets: pc.Targets, limits: pc.Limits, warm: pc.Solution | None,
    budget: pc.Budget, out: pc.Gains, relative: float,
) -> pc.Result:  # fmt: skip
    """Write the gains that come nearest to targets of given phases under the gain limit, or the strongest even ones.

    relative: mu over trace(B B^H) / M. Starts from the multipliers of `warm`, if it has any.
    """
    B = propagator.single
    M, N = B.shape
    mu = relative * propagator.power
    if not mu:
        return pc.Result(note="no transducer reaches the points")
    p, norm = targets.complex(targets.phases), targets.norm
    # without a gain limit, use a unit that no gain reaches: ||g|| <= ||p|| / (2 sqrt(mu))
    unit = limits.gain or norm / math.sqrt(mu)
    share = within(norm / unit, relative, mu, N)
    p *= share / unit
    key = Space, M, N
    space = acquire(key, lambda: Space.of(M, N))
    D = np.where(targets.beside, 1.0 / QUIET, 1.0)
    descent = Descent(B, p, D, begin(targets, warm) * (share / unit), mu, space, budget)
    strongest = targets.scale == "max"
    if strongest:
        reach = np.where(targets.beside, 0.0, np.abs(B).sum(axis=1, dtype=np.float64))
        climb(p, reach, descent.turn_to, budget)
        share = max(share, 1.0)  # the strength is free
    else:
        descent.run()
    p, y, scale, steps = descent.p, descent.y, unit / max(share, 1.0), descent.steps
    w = 1.0 / np.sqrt(D)  # factors on the rows, so that each error has its weight
    if not (strongest or descent.met or budget.spent):
        from pacinian_plugins.solvers.lagrange.convex import least_squares

        answer = least_squares(w[:, None] * propagator.B, w * p, mu=mu, start=y / w, budget=budget)
        out[:] = scale * answer.h
        y, bound, objective = w * answer.y, answer.bound, answer.objective
        steps += answer.steps
    elif out.dtype == np.complex64:
        deliver(space.h, scale, out)
        bound, objective = descent.proof()
    else:
        G, free = propagator.gram * np.outer(w, w), np.zeros(M, np.bool_)
        fine = solve_newton(w[:, None] * propagator.B, G, w * p, free, mu, y / w, REFINED, budget)
        out[:] = scale * fine.h
        y, bound, objective = w * fine.y, fine.bound, fine.objective
    held = int((np.abs(out) > AT_LIMIT * scale).sum())
    release(key, space, M * N)
    proven = (unit / share) ** 2 if share >= 1.0 and not strongest else math.nan
    return pc.Result(
        iterations=steps,
        limited=held > 0 and limits.gain is not None,
        late=budget.spent,
        bound=bound * proven,
        objective=objective * proven,
        multipliers=None if strongest else y * (unit / share),
        mu=mu,
        quiet_weight=QUIET,
        note=f"{held / N:.0%} of the transducers at their limit" if held else "",
    )


def begin(targets: pc.Targets, warm: pc.Solution | None) -> Complexes:
    """Return the starting multipliers, (M,) [Pa]: those of `warm`, turned with the phases, or else 0."""
    y = None if warm is None else warm.multipliers
    before = None if warm is None else warm.asked_phases
    if warm is None or y is None or before is None or not warm.targets.norm:
        return np.zeros(len(targets.amplitudes), np.complex128)
    turn = np.exp(1j * (targets.phases - before))
    return np.asarray(y * turn * (targets.norm / warm.targets.norm), np.complex128)
