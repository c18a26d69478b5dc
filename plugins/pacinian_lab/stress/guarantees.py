"""The guarantees, stated once, for the command and for the tests."""

from __future__ import annotations

from dataclasses import dataclass

from pacinian_lab.stress.case import DEFAULT_DEADLINE

TOLERANCE_PROVEN = 1e-6  # of bounds, relative to ||amplitudes||^2 or the objective
TOLERANCE_REACHED = 1e-4  # relative distance at which a limit counts as reached
TOLERANCE_MET = 1e-3  # relative error at which exact samples and quiet points count as met
TOLERANCE_PHASE = 1e-6  # [rad] of the phases of a region
TOLERANCE_SAMPLES = 0.05  # relative error at samples; 10 % of the radiation pressure
TOLERANCE_FORCE = 0.05  # relative error of the force between samples
MAX_RMS = 0.10  # relative error between samples, root mean square
MIN_FILLED = 0.5  # share of the target between samples; less is a hole
TOLERANCE_TIME = 1.0  # [s] after the deadline, because the machine may do other work
MAX_WORK = 10.0  # time after the deadline, relative to the time for B and B B^H
# relative to the mean of the diagonal: one rounding of a sum in single precision
TOLERANCE_GRAM = 1e-6

EVERY = {
    "raises": "no error and no warning, except the error that the problem calls for",
    "finite": "gains, pressures and errors are finite, and so is a reported bound",
    "gain": "|g_n| <= limits.gain, in extended precision",
    "power": "sum |g_n|^2 <= limits.power, summed without rounding",
    "true": "the reported sound pressures are those of the gains, within the rounding of B",
    "bound": "a reported objective and bound are those of these gains, within the rounding of B"
    f" plus {TOLERANCE_PROVEN:g}",
    "silent": "gains are zero if all targets are, and the status is silent if and only if they are",
    "strong": f'with scale="max" a limit is reached within {100 * TOLERANCE_REACHED:g} %,'
    " unless all gains are zero",
    "quiet": f"|p| <= limit at quiet points within {100 * TOLERANCE_MET:g} %, or the rounding of B",
    "exact": f"exact samples are met within {100 * TOLERANCE_MET:g} %, or the status is infeasible",
    "together": "free phases of a region are those of one wave with a common phase,"
    f" within {TOLERANCE_PHASE:g} rad; given ones stay",
    "even": f"status ok for regions means: at most {100 * TOLERANCE_SAMPLES:g} % error at samples;"
    f" half way between them a force within {100 * TOLERANCE_FORCE:g} %,"
    f" an rms of at most {MAX_RMS:.2f}, no holes (less than {100 * MIN_FILLED:g} % of the target)",
    "late": f"returns by the deadline, plus {TOLERANCE_TIME:g} s,"
    f" plus {MAX_WORK:g} times the time for B and B B^H in double precision",
}
"""Guarantees of every solver, also of other plug-ins. A solver may refuse `quiet` and `exact` (UnsupportedLimit)."""

OURS = {
    "answers": f"never `failed`; done before a deadline of {DEFAULT_DEADLINE:g} s or more (at most"
    " 1024 samples with 36 transducers, or 441 with 861); and not all gains zero if sound reaches a"
    " point with a target, unless silence is near the best",
    "near": "the residual is within a factor of the best that the precision allows (`Near`)",
}
"""Further guarantees, of the solvers in `GUARANTEES`."""

PROPAGATOR = {
    "drift": "after any moves B equals a new propagator's bit by bit,"
    f" and its Gram matrix to {TOLERANCE_GRAM:g}",
}
"""Guarantees of the propagator that the solvers share."""


@dataclass(frozen=True)
class Near:
    """||p - B g|| <= factor * (||p - B g*||^2 + rounding ||g*||^2)^(1/2).

    g*: the gains with the smallest ||p - B g||^2 + (mu + rounding) ||g||^2. If `limited`, only gains within the limit
    are considered, and if they reach it, mu ||g*||^2 is included too. Otherwise all gains are considered, and the
    answer is judged at its best multiple. mu: relative to trace(B B^H) / M. rounding: (||E|| + max(M, N) eps ||B||)^2,
    where E is the possible rounding error of B (`Case.rounding`), because the precision of B limits what a solver can
    know. Within a limit the bracket is at least 1e-7 ||p||, because bounds are not known more precisely. free: also
    guaranteed if phases are free, for the phases found. With regions, p has the phases given to the solver, mu is
    `mu_regions`, and the bracket is at least `enough` times ||p||, because samples closer than the array resolves need
    no more.
    """

    factor: float
    limited: bool
    mu: float = 0.0
    free: bool = False
    mu_regions: float = 0.0
    enough: float = 0.0


@dataclass(frozen=True)
class Guarantee:
    """The guarantees of one solver besides `EVERY`, for at most `samples` samples."""

    answers: bool = False
    near: Near | None = None
    samples: int = 1 << 62


SILENCE = Near(factor=3.0, limited=False)
LAGRANGE = Guarantee(
    answers=True,
    near=Near(factor=1.2, limited=True, mu=1e-6, free=True, mu_regions=5e-3, enough=5e-3),
)
GUARANTEES = {
    "auto": LAGRANGE,
    "lagrange": LAGRANGE,
    # The largest residual in 8,000 random problems was 2.8 times the best (docs/stability.md).
    "pseudo-inverse": Guarantee(answers=True, near=Near(factor=5.0, limited=False)),
    "single-focus": Guarantee(answers=True, near=Near(factor=1.1, limited=True), samples=1),
    "gs": Guarantee(answers=True),
    "gs-pat": Guarantee(answers=True),
    "weighted-gs": Guarantee(answers=True),
    "greedy": Guarantee(answers=True),
    "lbfgs": Guarantee(answers=True),
}


def get_guarantee(solver: str) -> Guarantee:
    """Return the guarantees of the solver of this name. Unknown solvers guarantee only `EVERY`."""
    return GUARANTEES.get(solver, Guarantee())
