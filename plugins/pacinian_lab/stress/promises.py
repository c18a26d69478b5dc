"""What is promised of an answer, stated once: the command checks it, and so do the tests."""

from __future__ import annotations

from dataclasses import dataclass

EVERY = {
    "raises": "nothing is raised or warned of, but the error that the problem calls for",
    "finite": "gains, pressures and errors are finite, and so is a bound that is given",
    "gain": "|g_n| <= limits.gain, in extended precision",
    "power": "sum |g_n|^2 <= limits.power, summed without rounding",
    "true": "the sound pressures told are those of the gains, within the rounding of B",
    "bound": "objective and bound, where given, are those of these gains within the rounding of B",
    "silent": "all gains are zero where nothing is asked, and the status says so exactly then",
    "strong": 'with scale="max" a limit is reached, unless all gains are zero',
    "quiet": "|p| <= limit at quiet points within 0.1 %, or the rounding of B",
    "exact": "exact samples are met within 0.1 %, or the status is infeasible",
    "together": "free phases of a region are those of one wave, turned as a whole; given ones stay",
    "even": "a region of status ok is: 5 % off at most at its samples; half way between these"
    " force within 5 %, rms at most 0.10, no holes",
    "late": "back within the deadline, 1 s, and 10 times what B and B B^H take in double precision",
}
"""Of every solver, also those of others; it may refuse `quiet` and `exact` (UnsupportedLimit)."""

OURS = {
    "answers": "never `failed`, not still at work after 3 s on problems this small, and not all"
    " gains zero where sound reaches a point that asks, unless that is near the best",
    "near": "the residual is within a factor of the best that the precision allows: `Near`",
}
"""Besides, of the solvers in `PROMISES`."""

PROPAGATOR = {
    "drift": "after any moves B is bit by bit what a new propagator has, its Gram matrix to 1e-6",
}
"""Of the propagator that they share."""


@dataclass(frozen=True)
class Near:
    """||p - B g|| <= factor * (||p - B g*||^2 + rounding ||g*||^2)^(1/2).

    g*: the gains of the least ||p - B g||^2 + (mu + rounding) ||g||^2; if `limited`, of those within the
    limit, and where they reach it mu ||g*||^2 counts too. Else of all, and the answer counts as it was
    before it was scaled down as a whole.
    mu: relative to trace(B B^H) / M. rounding: (||E|| + max(M, N) eps ||B||)^2, E being what rounding
    can do to B (`Case.rounding`): no more is asked than B in its precision can tell. Within a limit the
    bracket is at least 1e-7 ||p||: bounds are told no better.
    free: also promised where phases are free, for the phases found.
    With regions, p has the phases that the solver was given, mu is `mu_regions`, and the bracket is at least
    `enough` times ||p||: samples closer than the array resolves need no more.
    """

    factor: float
    limited: bool
    mu: float = 0.0
    free: bool = False
    mu_regions: float = 0.0
    enough: float = 0.0


@dataclass(frozen=True)
class Promise:
    """What one solver promises besides `EVERY`, for at most so many samples."""

    answers: bool = False
    near: Near | None = None
    samples: int = 1 << 62


SILENCE = Near(factor=3.0, limited=False)
LAGRANGE = Promise(
    answers=True,
    near=Near(factor=1.2, limited=True, mu=1e-6, free=True, mu_regions=5e-3, enough=5e-3),
)
PROMISES = {
    "auto": LAGRANGE,
    "lagrange": LAGRANGE,
    # it cuts at the rounding of sums, not of phases: 14 at most in 26,000 random problems
    "pseudo-inverse": Promise(answers=True, near=Near(factor=5.0, limited=False)),
    "single-focus": Promise(answers=True, near=Near(factor=1.1, limited=True), samples=1),
    "gs": Promise(answers=True),
    "gs-pat": Promise(answers=True),
    "weighted-gs": Promise(answers=True),
    "greedy": Promise(answers=True),
    "lbfgs": Promise(answers=True),
}


def of(solver: str) -> Promise:
    """What the solver of that name promises; a stranger, `EVERY` only."""
    return PROMISES.get(solver, Promise())
