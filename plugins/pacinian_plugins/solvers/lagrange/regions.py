"""Least squares under the gain limit for regions: all phases are given, and no Gram matrix is formed.

The samples of a region lie closer together than the array resolves. Therefore B B^H is nearly singular, and its
regularisation mu affects the solution. Squared errors have weight 1, or `BESIDE_WEIGHT` beside regions; the quiet
factor (`quiet_factor`) multiplies both this weight and mu. The dual is that of `convex.dual`: y solves
F(y) = p - D y - B h(B^H y) = 0, where D is 1 over the weights. Newton steps find y. Each step solves
(D + B W B^H) d = F by conjugate gradients, with W = dh/dx: 1 / mu in both directions for a gain below its limit, and
1 / |x| along its phase for a gain at its limit. Each product reads B once.

Some of the transducers suffice to capture the coupling of nearby samples: all of a small array, and every fourth of a
large one. D + B W B^H is computed and factored for these only, and preconditions the conjugate gradients. This needs 2
to 4 products instead of 30 to 60. The coupling hardly changes while samples move together, so the next solve begins
with the same preconditioner. If the samples are many, or lie far apart, only blocks on the diagonal are factored.

An error d of the sound pressure changes the radiation pressure by 2 |p| d where the target is |p|, but only by d^2
where the target is 0. So a small weight keeps points beside a region quiet, and leaves the region itself unchanged.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

import pacinian as pc
from pacinian.solving.skin_phases import BESIDE_WEIGHT
from pacinian.solving.solution_metrics import AT_LIMIT
from pacinian_plugins.native.lagrange import (
    RegionWorkspace,
    find_loudest,
    scale_for_single,
    solve_region,
    start_region,
    write_gains,
)
from pacinian_plugins.solvers.lagrange.quiet_factor import (
    MAX_COLD_CHANGES,
    MAX_WARM_CHANGES,
    NEAR,
    adapt_factor,
    find_last_factor,
)
from pacinian_plugins.solvers.lagrange.reference import solve_newton
from pacinian_plugins.solvers.lagrange.solve_arguments import describe_saturation
from pacinian_plugins.solvers.lagrange.strongest_uniform import find_strongest_uniform

if TYPE_CHECKING:
    from pacinian.types import Complexes, Floats, Gains, Indices
    from pacinian_plugins.solvers.lagrange.solve_arguments import SolveArguments

# Least number of transducers in the preconditioner of an array that has more, and largest stride from one to the next.
MIN_COLUMNS, MAX_STRIDE = 500, 4
# Largest number of samples whose preconditioner is one block, and largest size of the blocks of more samples.
MAX_SINGLE_BLOCK_SIZE, MAX_BLOCK_SIZE = 512, 256
# Largest width of a block [m]. Every fourth transducer (40 mm apart) would couple samples at larger distances that the
# whole array does not couple.
MAX_BLOCK_WIDTH = 0.075
# Largest duality gap of the last multipliers, relative to that of none, to start from them: if they had converged, and
# if there was no time for that. If late solves began anew each time, none of them would ever converge (decision 75).
MAX_START_GAP, MAX_LATE_START_GAP = 0.25, 1.0
# largest difference between the movements of two samples for which the last preconditioner is used [m]
MAX_DISTORTION = 1e-3
MAX_REFINING_STEPS = 16  # Newton steps in double precision
NOTHING, NO_PHASES = np.empty(0, np.complex128), np.empty(0)


class Ascent:
    """Newton steps on the multipliers y, (M,), from a given start, for targets p, (M,) [Pa per unit limit].

    D: 1 over the weights of the squared errors, (M,). factor: the quiet factor that D and mu contain.
    """

    def __init__(
        self, B: Gains, p: Complexes, D: Floats, y: Complexes, mu: float,
        max_gap: float, workspace: RegionWorkspace, budget: pc.Budget, factor: float = 1.0,
    ) -> None:  # fmt: skip
        self.B, self.p, self.D, self.y, self.mu, self.max_gap = B, p, D, y, mu, max_gap
        self.factor, self.workspace, self.budget = factor, workspace, budget
        self.steps = 0

    def run(self) -> None:
        """Take steps until F is small or nothing improves; the gains are in the workspace."""
        self.steps += solve_region(
            self.B, self.p, self.D, self.mu, self.y, self.max_gap, self.workspace,
            lambda: self.budget.spent,
        )  # fmt: skip

    def turn_to(self, p: Complexes) -> Complexes:
        """Continue with other targets, (M,), of the same phases; return the pressures made, (M,)."""
        self.y *= np.linalg.norm(p) / np.linalg.norm(self.p)
        self.p = p
        self.run()
        return np.asarray(self.workspace.made[0] + 1j * self.workspace.made[1])

    def quieten(self, propagator: pc.Propagator, targets: pc.Targets, changes: int) -> None:
        """Continue with other quiet factors, until the skin beside the regions is quiet enough.

        changes: largest number of these. See `quiet_factor`.
        """
        regions = targets.regions
        assert regions is not None
        frequency = propagator.array.transducer.frequency
        near = NEAR * 2.0 * math.pi / propagator.medium.wavenumber(frequency)
        for _ in range(changes):
            if self.budget.spent or not self.workspace.met:
                return
            loudness = find_loudest(propagator.points, regions, self.p, self.workspace.made, near)
            saturation = self.workspace.held / self.B.shape[1]
            factor = adapt_factor(self.factor, loudness, saturation)
            if factor == self.factor:
                return
            ratio, self.factor = factor / self.factor, factor
            self.D[targets.beside] /= ratio
            self.mu *= ratio
            self.y *= ratio  # about the same gains
            self.workspace.restart(True)
            self.run()


def solve(arguments: SolveArguments, relative: float) -> pc.Result:
    """Write the gains that come nearest to targets of given phases under the gain limit, or the strongest even ones.

    relative: mu over trace(B B^H) / M. Starts from the multipliers of `warm`, if it has any.
    """
    propagator, targets, limits, warm, budget, out = arguments
    B = propagator.single
    M, N = B.shape
    mu = relative * propagator.power
    if not mu:
        return pc.Result(note="no transducer reaches the points")
    norm = targets.norm
    # without a gain limit, use a unit that no gain reaches: ||g|| <= ||p|| / (2 sqrt(mu))
    unit = limits.gain or norm / math.sqrt(mu)
    share = scale_for_single(norm / unit, relative, mu, N)
    p: Complexes = np.empty(M, np.complex128)
    y: Complexes = np.empty(M, np.complex128)
    D, scale = np.empty(M), share / unit
    before, phases, ratio = find_start(targets, warm)
    strongest, continues = arguments.strongest, len(before) > 0
    factor = find_last_factor(warm) if continues and not strongest else 1.0
    start_region(
        targets.amplitudes, targets.phases, targets.beside, scale, BESIDE_WEIGHT * factor, before, phases,
        scale * ratio, p, D, y,
    )  # fmt: skip
    workspace = find_workspace(propagator, continues and moved_together(propagator, warm))
    max_gap = MAX_LATE_START_GAP if warm is not None and warm.late else MAX_START_GAP
    ascent = Ascent(B, p, D, y, factor * mu, max_gap, workspace, budget, factor)
    if strongest:
        reach = np.where(targets.beside, 0.0, np.abs(B).sum(axis=1, dtype=np.float64))
        find_strongest_uniform(p, reach, ascent.turn_to, budget)
        share = max(share, 1.0)  # the strength is free
    else:
        ascent.run()
        if targets.beside.any():
            changes = MAX_WARM_CHANGES if continues else MAX_COLD_CHANGES
            ascent.quieten(propagator, targets, changes)
    p, y, mu, scale, steps = ascent.p, ascent.y, ascent.mu, unit / max(share, 1.0), ascent.steps
    done = strongest or workspace.met or budget.spent
    if done and out.dtype == np.complex64:
        write_gains(workspace.h, scale, out)
        bound, objective, saturated_count = workspace.bound, workspace.objective, workspace.held
    else:
        w = 1.0 / np.sqrt(D)  # factors on the rows, so that each error has its weight
        A, start_at = w[:, None] * propagator.B, y / w
        if done:
            G, free = propagator.gram * np.outer(w, w), np.zeros(M, np.bool_)
            fine = solve_newton(A, G, w * p, free, mu, start_at, MAX_REFINING_STEPS, budget)
            h, y, bound, objective = fine.h, w * fine.y, fine.bound, fine.objective
        else:
            from pacinian_plugins.solvers.lagrange.convex import least_squares

            answer = least_squares(A, w * p, mu=mu, start=start_at, budget=budget)
            h, y, bound, objective = answer.h, w * answer.y, answer.bound, answer.objective
            steps += answer.steps
        out[:] = scale * h
        saturated_count = int((np.abs(out) > AT_LIMIT * scale).sum())
    bound_scale = (unit / share) ** 2 if share >= 1.0 and not strongest else math.nan
    return pc.Result(
        iterations=steps,
        limited=saturated_count > 0 and limits.gain is not None,
        late=budget.spent,
        bound=bound * bound_scale,
        objective=objective * bound_scale,
        multipliers=None if strongest else y * (unit / share),
        mu=mu,
        quiet_weight=BESIDE_WEIGHT * ascent.factor,
        note=describe_saturation(saturated_count, N),
    )


def find_workspace(propagator: pc.Propagator, same: bool) -> RegionWorkspace:
    """Return the workspace that the propagator keeps from the last solve, or a new one for other numbers.

    same: whether its preconditioner serves again, because the samples are the same or have moved as one.
    """
    M, N = propagator.B.shape
    kept = propagator.workspace
    if not isinstance(kept, RegionWorkspace) or kept.made.shape[1] != M:
        kept = None
    if kept is None or not same:
        stride = min(max(1, N // MIN_COLUMNS), MAX_STRIDE)
        blocks = divide_samples(propagator.points, math.inf if stride == 1 else MAX_BLOCK_WIDTH)
        sizes = np.array([len(block) for block in blocks])
        kept = propagator.workspace = RegionWorkspace(M, N, sizes, stride)
        kept.order[:] = np.concatenate(blocks)
    kept.restart(same)
    return kept


def divide_samples(points: Floats, width: float) -> list[Indices]:
    """Return the samples of each block of the preconditioner, so that it is small, and at most `width` [m] wide."""
    blocks: list[Indices] = []
    open_ = [(np.arange(len(points)), MAX_SINGLE_BLOCK_SIZE)]
    while open_:
        block, most = open_.pop()
        x, size = _along_longest_side(points[block])
        if size > width:
            first = x < x.min() + size / 2.0
        elif len(block) > most:
            first = np.argsort(np.argsort(x, kind="stable")) < len(x) // 2
        else:
            blocks.append(block)
            continue
        open_ += (block[~first], MAX_BLOCK_SIZE), (block[first], MAX_BLOCK_SIZE)
    return blocks


def _along_longest_side(q: Floats) -> tuple[Floats, float]:
    """Return the coordinates of points along the longest side of their box, (M,) [m], and its length [m]."""
    sides = np.ptp(q, axis=0)
    return q[:, sides.argmax()], float(sides.max())


def moved_together(propagator: pc.Propagator, warm: pc.Solution | None) -> bool:
    """Return whether the samples are those of the last solution, in the same order, and have moved as one."""
    if warm is None or warm.points.shape != propagator.points.shape:
        return False
    moved = propagator.points - warm.points
    return float(np.abs(moved - moved[0]).max(initial=0.0)) < MAX_DISTORTION


def find_start(targets: pc.Targets, warm: pc.Solution | None) -> tuple[Complexes, Floats, float]:
    """Return the multipliers to start from, (M,) [Pa], their phases, and a factor: those of `warm`, or nothing."""
    y = None if warm is None else warm.multipliers
    before = None if warm is None else warm.asked_phases
    if warm is None or y is None or before is None or not warm.targets.norm:
        return NOTHING, NO_PHASES, 0.0
    return y, before, targets.norm / warm.targets.norm
