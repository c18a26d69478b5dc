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

import pacinian as pc
from pacinian.solving.buffer_pool import acquire, release
from pacinian.solving.solution_values import AT_LIMIT
from pacinian_plugins.native.lagrange import TILE, ascend, deliver, start, within
from pacinian_plugins.solvers.lagrange.evenly import climb
from pacinian_plugins.solvers.lagrange.reference import solve_newton

if TYPE_CHECKING:
    from pacinian.types import Complexes, Floats, Gains, Singles

QUIET = 0.02  # weight of points beside regions
MAX_SAMPLES = 400  # largest number of samples with a preconditioner
REFINED = 16  # Newton steps in double precision
NOTHING, NO_PHASES = np.empty(0, np.complex128), np.empty(0)


class Space(NamedTuple):
    """Workspace of the kernels for M samples and N transducers."""

    tile: Singles
    h: Singles  # gains and |x_n|, (3, N)
    made: Floats  # result of the last kernel, (2, M)
    factor: Singles  # the preconditioner, or nothing
    found: Floats  # outputs of the kernel `ascend`

    @classmethod
    def of(cls, M: int, N: int) -> Space:
        """Allocate the workspace for M samples and N transducers."""
        K = M + M % 2 if M <= MAX_SAMPLES else 0
        return cls(
            np.zeros((2, M + -M % 4, TILE), np.float32),
            np.zeros((3, N), np.float32),
            np.zeros((2, M)),
            np.zeros((2, K, K), np.float32),
            np.zeros(6),
        )


class Ascent:
    """Newton steps on the multipliers y, (M,), from a given start, for targets p, (M,) [Pa per unit limit].

    D: 1 over the weights of the squared errors, (M,).
    """

    def __init__(
        self, B: Gains, p: Complexes, D: Floats, y: Complexes, mu: float, space: Space,
        budget: pc.Budget,
    ) -> None:  # fmt: skip
        self.B, self.p, self.D, self.y, self.mu, self.space = B, p, D, y, mu, space
        self.budget = budget
        self.steps = 0
        space.found[:] = 0.0

    def run(self) -> None:
        """Take steps until F is small or nothing improves; the gains are in the workspace."""
        space = self.space
        self.steps += ascend(
            self.B, self.p, self.D, self.mu, self.y, space.h, space.made, space.tile, space.factor,
            space.found, lambda: self.budget.spent,
        )  # fmt: skip

    def turn_to(self, p: Complexes) -> Complexes:
        """Continue with other targets, (M,), of the same phases; return the pressures made, (M,)."""
        self.y *= np.linalg.norm(p) / np.linalg.norm(self.p)
        self.p = p
        self.run()
        return np.asarray(self.space.made[0] + 1j * self.space.made[1])

    @property
    def met(self) -> bool:
        """Whether the steps have converged."""
        return bool(self.space.found[0])

    @property
    def proof(self) -> tuple[float, float]:
        """D(y), and 1/2 sum_m |p - B h|_m^2 / D_m + mu/2 ||h||^2."""
        return float(self.space.found[1]), float(self.space.found[2])

    @property
    def held(self) -> int:
        """Number of gains at their limit."""
        return int(self.space.found[3])


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
    norm = targets.norm
    # without a gain limit, use a unit that no gain reaches: ||g|| <= ||p|| / (2 sqrt(mu))
    unit = limits.gain or norm / math.sqrt(mu)
    share = within(norm / unit, relative, mu, N)
    p: Complexes = np.empty(M, np.complex128)
    y: Complexes = np.empty(M, np.complex128)
    D, scale = np.empty(M), share / unit
    before, phases, factor = begin(targets, warm)
    start(
        targets.amplitudes, targets.phases, targets.beside, scale, QUIET, before, phases, scale * factor,
        p, D, y,
    )  # fmt: skip
    key = Space, M, N, M <= MAX_SAMPLES
    space = acquire(key, lambda: Space.of(M, N))
    ascent = Ascent(B, p, D, y, mu, space, budget)
    strongest = targets.scale == "max"
    if strongest:
        reach = np.where(targets.beside, 0.0, np.abs(B).sum(axis=1, dtype=np.float64))
        climb(p, reach, ascent.turn_to, budget)
        share = max(share, 1.0)  # the strength is free
    else:
        ascent.run()
    p, y, scale, steps = ascent.p, ascent.y, unit / max(share, 1.0), ascent.steps
    done = strongest or ascent.met or budget.spent
    if done and out.dtype == np.complex64:
        deliver(space.h, scale, out)
        (bound, objective), held = ascent.proof, ascent.held
    else:
        w = 1.0 / np.sqrt(D)  # factors on the rows, so that each error has its weight
        A, start_at = w[:, None] * propagator.B, y / w
        if done:
            G, free = propagator.gram * np.outer(w, w), np.zeros(M, np.bool_)
            fine = solve_newton(A, G, w * p, free, mu, start_at, REFINED, budget)
            h, y, bound, objective = fine.h, w * fine.y, fine.bound, fine.objective
        else:
            from pacinian_plugins.solvers.lagrange.convex import least_squares

            answer = least_squares(A, w * p, mu=mu, start=start_at, budget=budget)
            h, y, bound, objective = answer.h, w * answer.y, answer.bound, answer.objective
            steps += answer.steps
        out[:] = scale * h
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


def begin(targets: pc.Targets, warm: pc.Solution | None) -> tuple[Complexes, Floats, float]:
    """Return the multipliers to start from, (M,) [Pa], their phases, and a factor: those of `warm`, or nothing."""
    y = None if warm is None else warm.multipliers
    before = None if warm is None else warm.asked_phases
    if warm is None or y is None or before is None or not warm.targets.norm:
        return NOTHING, NO_PHASES, 0.0
    return y, before, targets.norm / warm.targets.norm
