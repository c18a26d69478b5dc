"""Run every problem with every solver, and the propagator through many moves."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from itertools import groupby
from typing import TYPE_CHECKING

import numpy as np

from pacinian.acoustics.air import Air
from pacinian.plugins import registry
from pacinian.solving.propagator import Propagator
from pacinian_lab.stress.check import Evidence, check
from pacinian_lab.stress.guarantees import TOLERANCE_GRAM, get_guarantee
from pacinian_lab.stress.problem_parts import SMALL_ARRAY, scatter_points

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from pacinian_lab.stress.case import Case

HURRY = 0.03  # [s] deadline for solvers that guarantee nothing about the optimum
MOVED = 8  # number of points that `drift` moves
COMPARISONS = 20  # number of comparisons with a new propagator


@dataclass(frozen=True)
class Row:
    """One family and one solver: number of problems, broken guarantees, and the worst of the evidence."""

    family: str
    solver: str
    problems: int
    broken: tuple[Evidence, ...]
    excess: float
    ratio: float
    seconds: float
    where: str


def solvers() -> list[str]:
    """Return the installed solvers that need no settings."""
    offers = [offer for offer in registry.discover_plugins().list() if offer.kind == "solver"]
    return [offer.name for offer in offers if ... not in offer.options.values()]


def run(
    names: Iterable[str],
    problems: Iterable[Case],
    advance: Callable[[str], object] = lambda _: None,
) -> list[Evidence]:
    """Return evidence of each solver on each problem. Raises UnknownPlugin.

    advance: called with the name of the next task. Solvers that guarantee nothing about the optimum get only `HURRY`
    seconds per problem, because their other guarantees hold whenever they stop.
    """
    made = [registry.solver(name) for name in names]
    found: list[Evidence] = []
    for case in problems:
        hurried = replace(case, deadline=min(case.deadline, HURRY))
        for solver in made:
            advance(f"{solver.name}, {case.name}")
            found.append(check(case if get_guarantee(solver.name).near else hurried, solver))
    return found


def rows(found: Iterable[Evidence]) -> list[Row]:
    """Summarise the evidence by family and solver."""
    first: dict[tuple[str, str], int] = {}

    def place(e: Evidence) -> tuple[str, str]:
        return e.case.partition(":")[0], e.solver

    evidence = list(found)
    for e in evidence:
        first.setdefault(place(e), len(first))
    ordered = sorted(evidence, key=lambda e: first[place(e)])
    return [_row(*key, list(group)) for key, group in groupby(ordered, key=place)]


def _row(family: str, solver: str, found: list[Evidence]) -> Row:
    broken = tuple(e for e in found if e.broken)
    worst = max(found, key=lambda e: -1.0 if math.isnan(e.ratio) else e.ratio)
    where = broken[0] if broken else worst
    return Row(
        family,
        solver,
        len(found),
        broken,
        _find_largest(e.excess for e in found),
        worst.ratio,
        _find_largest(e.seconds for e in found),
        "" if math.isnan(worst.ratio) and not broken else where.case.partition(": ")[2],
    )


def _find_largest(values: Iterable[float]) -> float:
    """Return the largest value, ignoring NaN, or NaN if there is none."""
    return max((v for v in values if not math.isnan(v)), default=math.nan)


def drift(updates: int) -> Evidence:
    """Move one point after another, and compare with a new propagator at intervals."""
    rng, air = np.random.default_rng(0), Air()
    array = SMALL_ARRAY.remove_transducers(range(16, len(SMALL_ARRAY)))
    q = scatter_points(MOVED)
    kept = Propagator(array, air)
    broken: dict[str, str] = {}
    worst = 0.0
    for n in range(1, updates + 1):
        q = q.copy()
        q[rng.integers(MOVED)] = rng.uniform((-0.05, -0.05, 0.05), (0.05, 0.05, 0.15))
        kept.set_points(q)
        G = kept.gram
        if n % max(1, updates // COMPARISONS) == 0:
            new = Propagator(array, air)
            new.set_points(q)
            worst = max(worst, float(np.abs(G - new.gram).max()) / new.power)
            if not np.array_equal(kept.B, new.B):
                broken["drift"] = f"B differs after {n} moves"
    if worst > TOLERANCE_GRAM:
        broken["drift"] = f"the Gram matrix is {worst:.2g} off"
    return Evidence(
        f"moves: {updates} of single points", "propagator", broken, ratio=worst / TOLERANCE_GRAM
    )
