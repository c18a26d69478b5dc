"""Check the guarantees about regions independently of the session: by brute force, in double precision."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from pacinian.acoustics.propagation import matrix
from pacinian.solving.region_phases import joint_phases
from pacinian.solving.solution_status import Status
from pacinian_lab.stress.guarantees import (
    MAX_RMS,
    MIN_FILLED,
    TOLERANCE_FORCE,
    TOLERANCE_PHASE,
    TOLERANCE_SAMPLES,
)

if TYPE_CHECKING:
    from collections.abc import Iterator

    from pacinian.solving.solution import Solution
    from pacinian.types import Complexes, Floats
    from pacinian_lab.stress.case import Case

NEIGHBOURS = 1.5  # neighbours are within this many times the distance of the nearest sample
ELSEWHERE = 1e-4  # [m]; samples closer than this count as one place
ON = 2e-5  # [m]; places closer than this to a transducer are skipped


def find_split_regions(case: Case, solution: Solution, g: Complexes) -> Iterator[tuple[str, str]]:
    """Yield the broken ones of the guarantees `together` and `even`, with figures."""
    if case.targets.regions is None or not case.targets.norm:
        return
    yield from _together(case, solution)
    if solution.status is Status.ok:
        yield from _check_even(case, solution, g)


def _together(case: Case, solution: Solution) -> Iterator[tuple[str, str]]:
    """Check that given phases stay, and that the others of a region are those of one wave with a common phase."""
    asked, given, regions = solution.asked_phases, ~case.targets.free, case.targets.regions
    assert regions is not None
    if asked is None or not np.isfinite(asked).all():
        yield "together", "no phases are reported"
        return
    if not np.array_equal(asked[given], case.targets.phases[given]):
        yield "together", "phases that were given are changed"
    for number in range(int(regions.max()) + 1):
        own = np.flatnonzero(regions == number)
        free = ~given[own]
        if not free.any():
            continue
        wave = joint_phases(
            case.array, case.points[own], case.medium,
            radiation_pressure=case.targets.amplitudes[own] ** 2,
        )  # fmt: skip
        turn = np.exp(1j * (asked[own] - wave))[free]
        off = float(np.abs(np.angle(turn * turn[0].conj())).max())
        if off > TOLERANCE_PHASE:
            yield "together", f"phases of region {number} are {off:.2g} rad off one wave"


def _check_even(case: Case, solution: Solution, g: Complexes) -> Iterator[tuple[str, str]]:
    """Check `ok` at the samples of each region and half way between them."""
    regions, sounding = case.targets.regions, ~case.targets.beside
    assert regions is not None
    p, t = np.where(sounding, case.B @ g, 0.0), case.targets.amplitudes
    strength = 1.0 if case.scale == "exact" else float(np.linalg.norm(p) / np.linalg.norm(t))
    t = strength * t
    doubt = case.blur * float(np.linalg.norm(g)) / float(np.linalg.norm(t))  # due to rounding
    asked = strength * case.targets.complex(np.angle(p))
    missed = float(np.linalg.norm(asked - p) / np.linalg.norm(t))
    if missed > TOLERANCE_SAMPLES + doubt:
        yield "even", f"{missed:.2%} off at the samples"
    unit = float(t.max())  # keeps squares from underflow and overflow
    for number in range(int(regions.max()) + 1):
        own = np.flatnonzero((regions == number) & sounding)
        if not len(own):
            continue
        places, P = _find_midpoints(case, case.points[own], (t[own] / unit) ** 2)
        if not P.any():
            continue
        made = np.abs(matrix(case.array, places, case.medium) @ g / unit) ** 2
        force = float(made.sum() / P.sum())
        rms = float(np.linalg.norm(made - P) / np.linalg.norm(P))
        holes = int((made < (MIN_FILLED - 4.0 * doubt) * P).sum())
        if abs(force - 1.0) > TOLERANCE_FORCE + 4.0 * doubt or rms > MAX_RMS + 4.0 * doubt or holes:
            text = f"force {force:.3f}, rms {rms:.3f}, {holes} holes of {len(P)}"
            yield "even", f"{text} between the samples of region {number}"


def _find_midpoints(case: Case, q: Floats, P: Floats) -> tuple[Floats, Floats]:
    """Return places (K, 3) half way between neighbours, except on transducers, and the targets there, (K,)."""
    _, some = np.unique(np.round(q / ELSEWHERE), axis=0, return_index=True)
    d = np.sqrt(((q[some][:, None] - q[some]) ** 2).sum(axis=2))
    apart = np.where(d > ELSEWHERE, d, np.inf)
    nearest = apart.min(axis=1)
    if not np.isfinite(nearest).any():
        return q[some[:1]], P[some[:1]]
    near = (d <= NEIGHBOURS * nearest[:, None]) & np.isfinite(nearest)[:, None]
    first, second = np.nonzero(np.triu(near | near.T, 1))
    places = (q[some[first]] + q[some[second]]) / 2.0
    asked = (P[some[first]] + P[some[second]]) / 2.0
    away = np.sqrt(((places[:, None] - case.array.positions) ** 2).sum(axis=2)).min(axis=1)
    return places[away > ON], asked[away > ON]
