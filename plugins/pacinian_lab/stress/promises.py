"""The promises, stated once, for the command and for the tests."""

from __future__ import annotations

from dataclasses import dataclass

EVERY = {
    "raises": "no error and no warning, except the error that the problem calls for",
    "finite": "gains, pressures and errors are finite, and so is a reported bound",
    "gain": "|g_n| <= limits.gain, in extended precision",
    "power": "sum |g_n|^2 <= limits.power, summed without rounding",
    "true": "the reported sound pressures are those of the gains, within the rounding of B",
    "bound": "a reported objective and bound are those of these gains, within the rounding of B",
    "silent": "gains are zero if all targets are, and the status is silent if and only if they are",
    "strong": 'with scale="max" a limit is reached, unless all gains are zero',
    "quiet": "|p| <= limit at quiet points within 0.1 %, or the rounding of B",
    "exact": "exact samples are met within 0.1 %, or the status is infeasible",
    "together": "free phases of a region are those of one wave with a common phase; given ones stay",
    "even": "status ok for regions means: at most 5 % error at samples; half way between them"
    " a force within 5 %, an rms of at most 0.10, no holes",
    "late": "returns by the deadline, plus 1 s, plus 10 times the time for B and B B^H in double precision",
}
"""Promises of every solver, also of other plug-ins. A solver may refuse `quiet` and `exact` (UnsupportedLimit)."""

OURS = {
    "answers": "never `failed`, at most 3 s on problems this small, and not all"
    " gains zero if sound reaches a point with a target, unless silence is near the best",
    "near": "the residual is within a factor of the best that the precision allows (`Near`)",
}
"""Further promises, of the solvers in `PROMISES`."""

PROPAGATOR = {
    "drift": "after any moves B equals a new propagator's bit by bit, and its Gram matrix to 1e-6",
}
"""Promises of the propagator that the solvers share."""


@dataclass(frozen=True)
class Near:
    """||p - B g|| <= factor * (||p - B g*||^2 + rounding ||g*||^2)^(1/2).

    g*: the gains with the smallest ||p - B g||^2 + (mu + rounding) ||g||^2. If `limited`, only gains within the limit
    are considered, and if they reach it, mu ||g*||^2 is included too. Otherwise all gains are considered, and the
    answer is judged before it is scaled down as a whole. mu: relative to trace(B B^H) / M. rounding: (||E|| + max(M,
    N) eps ||B||)^2, where E is the possible rounding error of B (`Case.rounding`), because the precision of B limits
    what a solver can know. Within a limit the bracket is at least 1e-7 ||p||, because bounds are not known more
    precisely. free: also promised if phases are free, for the phases found. With regions, p has the phases given to
    the solver, mu is `mu_regions`, and the bracket is at least `enough` times ||p||, because samples closer than the
    array resolves need no more.
    """

    factor: float
    limited: bool
    mu: float = 0.0
    free: bool = False
    mu_regions: float = 0.0
    enough: float = 0.0


@dataclass(frozen=True)
class Promise:
    """The promises of one solver besides `EVERY`, for at most `samples` samples."""

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
    # It cuts singular values at the rounding of sums, not of phases: a ratio of at most 14 in
    # 26,000 random problems.
    "pseudo-inverse": Promise(answers=True, near=Near(factor=5.0, limited=False)),
    "single-focus": Promise(answers=True, near=Near(factor=1.1, limited=True), samples=1),
    "gs": Promise(answers=True),
    "gs-pat": Promise(answers=True),
    "weighted-gs": Promise(answers=True),
    "greedy": Promise(answers=True),
    "lbfgs": Promise(answers=True),
}


def of(solver: str) -> Promise:
    """Return the promises of the solver of this name. Unknown solvers promise only `EVERY`."""
    return PROMISES.get(solver, Promise())
