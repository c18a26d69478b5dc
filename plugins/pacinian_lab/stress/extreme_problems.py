"""Hard demands: extreme targets, limits of every kind, many points, long series of moves."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from pacinian.acoustics.array import Array, autd
from pacinian.solving.limits import Limits
from pacinian_lab.stress.case import Case
from pacinian_lab.stress.problem_parts import (
    NO_LIMIT,
    PHASES,
    SMALL_ARRAY,
    compute_asked,
    half,
    row,
    scatter_points,
)

if TYPE_CHECKING:
    from collections.abc import Iterator

    from pacinian.types import ArrayLike, Floats


def extreme() -> Iterator[Case]:
    """Targets of 1e-30 to 1e30 Pa, mixed in one problem, denormal, zero."""
    q = scatter_points(6)
    problems = {
        f"{size:g} Pa": np.full(6, size)
        for size in (5e-324, 1e-310, 1e-45, 1e-38, *(10.0**n for n in range(-30, 31, 5)))
    } | {
        "1e-30 to 1e30 Pa": np.logspace(-30, 30, 6),
        "1 and 1e-20 Pa": np.array([1.0, 1e-20] * 3),
        "1 Pa and zeros": np.array([1.0, 0.0, 0.0] * 2),
        "1 Pa, zero and denormals": np.array([1.0, 0.0, 5e-324, 1e-310, 1e-38, 1e-45]),
        "zeros": np.zeros(6),
        "minus zeros": np.full(6, -0.0),
    }
    for size, t in problems.items():
        for what, phases in PHASES.items():
            case = Case(f"extreme: {size}, {what}", SMALL_ARRAY, q, t, phases)
            yield case
            yield replace(case, name=f"{case.name}, no limit", limits=NO_LIMIT)
            yield replace(case, name=f"{case.name}, max", scale="max")
    for size in (1e-30, 1.0, 1e30):
        one = Case(f"extreme: {size:g} Pa at one point", SMALL_ARRAY, q[:1], np.full(1, size))
        yield replace(one, limits=NO_LIMIT)
        name, t, mixed = f"extreme: {size:g} Pa, condition 1e12", np.full(5, size), np.arange(5.0)
        yield replace(one, name=name, points=row(1e12), amplitudes=t, phases=mixed**2)
    yield Case("extreme: phases of 1e300 rad", SMALL_ARRAY, q, np.full(6, 5.0), np.full(6, 1e300))


def saturated() -> Iterator[Case]:
    """Targets from well within reach to a million times beyond."""
    for level in (0.3, 0.7, 1.0, 1.3, 3.0, 30.0, 1e6):
        for M in (1, 2, 5, 12, 30, 45):
            q = scatter_points(M, seed=M)
            shares = np.random.default_rng(M).uniform(0.3, 1.0, M)
            for what, phases in {**PHASES, "half free": half(M)}.items():
                name = f"saturated: level {level:g}, {M} points, {what}"
                case = Case(
                    name, SMALL_ARRAY, q, compute_asked(SMALL_ARRAY, q, level, shares), phases
                )
                yield case
                if level == 1.0:
                    double = replace(case, precision="double")
                    yield replace(double, name=f"saturated: double, {M} points, {what}")
                    yield replace(
                        case, name=f"saturated: no limit, {M} points, {what}", limits=NO_LIMIT
                    )
                    yield replace(case, name=f"saturated: max, {M} points, {what}", scale="max")


def limits() -> Iterator[Case]:
    """Every kind of limit, alone and together, loose and tight."""
    q, quiet = scatter_points(5), np.array([[0.0, 0.0, 0.07], [0.02, 0.0, 0.07]])
    kinds: dict[str, dict[str, Any]] = {
        **{f"gain {g:g}": {"gain": g} for g in (1e-6, 1e-3, 0.1, 3.0, 1e6)},
        **{f"power {p:g}": {"power": p} for p in (1e-12, 1e-3, 1.0, 1e12)},
        "power only": {"gain": None, "power": 5.0},
        "quiet": {"quiet": (quiet, 1.0)},
        "quiet, silent": {"quiet": (quiet, 0.0)},
        "quiet on a target": {"quiet": (q[:1], 1.0)},
        "exact": {"exact": [0, 3]},
        "exact, all": {"exact": [0, 1, 2, 3, 4]},
        "all": {"gain": 0.8, "power": 9.0, "quiet": (quiet, 2.0), "exact": [1]},
    }
    for kind, given in kinds.items():
        for what, phases in PHASES.items():
            for level in (0.3, 3.0):
                t = compute_asked(SMALL_ARRAY, q, level, [1, 2, 3, 4, 5])
                name = f"limits: {kind}, level {level:g}, {what}"
                case = Case(name, SMALL_ARRAY, q, t, phases, Limits(**given))
                yield case
                if not case.limits.solver_limits:
                    yield replace(case, name=f"{name}, max", scale="max")
    few = Array(SMALL_ARRAY.positions[:9])
    for what, phases in {**PHASES, "half free": half(8)}.items():
        q = scatter_points(8)
        name = f"limits: gain 1, max, 8 points, 9 transducers, {what}"
        yield Case(name, few, q, compute_asked(few, q, 1.0, np.arange(1, 9)), phases, scale="max")
    steep = np.r_[
        scatter_points(2, height=2.0), SMALL_ARRAY.positions[[3]] + np.array([0.0, 0.0, 1e-4])
    ]
    name = "limits: power 1e-9, max, points near and far"
    yield Case(name, few, steep, np.full(3, 5.0), None, Limits(gain=None, power=1e-9), "max")


def size() -> Iterator[Case]:
    """From no points to 4096, with deadlines."""
    for M in (0, 1, 2, 35, 36, 37, 100, 256, 1024, 4096):
        for what, phases in PHASES.items():
            for deadline in (0.0, 0.05, 1.0):
                q = scatter_points(M, seed=M, width=0.2)
                name = f"size: {M} points, {what}, {deadline:g} s"
                t = compute_asked(SMALL_ARRAY, q, 0.6)
                yield Case(name, SMALL_ARRAY, q, t, phases, deadline=deadline, slow=M > 100)
    array = autd()
    for M in (64, 249, 4096):
        q = scatter_points(M, seed=M, width=0.2, height=0.2)
        name = f"size: {M} points, 249 transducers, 0.1 s"
        yield Case(name, array, q, compute_asked(array, q, 0.6), deadline=0.1, slow=True)


def moves() -> Iterator[Case]:
    """Sessions with earlier moves, other numbers of points, a refusal, silence and extremes."""
    for what, phases in PHASES.items():
        for M in (1, 6, 12):
            for level in (0.3, 1.5):
                rng = np.random.default_rng(M)
                q = scatter_points(M)
                history: list[tuple[Floats, ArrayLike]] = []
                for _ in range(40):
                    q = q.copy()
                    q[rng.integers(M)] = scatter_points(1, int(rng.integers(1 << 30)))
                    history.append((q, compute_asked(SMALL_ARRAY, q, level)))
                history[20:20] = [
                    (q[:0], []),
                    (SMALL_ARRAY.positions[:2], [1.0, 1.0]),
                    (np.resize(q, (M + 3, 3)), np.ones(M + 3)),
                    (q, np.zeros(M)),
                    (q, np.full(M, 1e30)),
                    (q, np.full(M, 1e-30)),
                ]
                name = f"moves: 40 of {M} points, level {level:g}, {what}"
                yield Case(
                    name,
                    SMALL_ARRAY,
                    q,
                    compute_asked(SMALL_ARRAY, q, level),
                    phases,
                    history=history,
                )
        for start, end in ((1e-30, 1e30), (1e30, 1e-30), (1.0, 1e-30), (0.0, 1.0)):
            for limit in (NO_LIMIT, Limits()):
                name = f"moves: none, {start:g} then {end:g} Pa, limit {limit.gain}, {what}"
                q, before = row(1e6), np.full(5, start)
                yield Case(
                    name, SMALL_ARRAY, q, np.full(5, end), phases, limit, history=[(q, before)]
                )
