"""The paper's numerical experiment (section 5): two regions, two arrangements, four patterns."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy import linalg

import pacinian as pc
from pacinian.errors import ArgumentError

if TYPE_CHECKING:
    from collections.abc import Callable

    from pacinian.types import Floats

HALF = 0.2  # half the side of a region [m]
COUNT = 41  # samples along a side: every 10 mm
DISTANCE = 0.2  # height of the regions' centre [m]
CUT = 1e-10  # singular values below this fraction of the largest count as zero
EDGE = 1e-9  # by how much a sample must be inside the disc, so that rounding does not take sides
MEDIUM = pc.Air(speed_of_sound=340.0, density=1.2, attenuation="none")
CASES = ("1a", "1b", "2a", "2b")
PATTERNS = ("ring", "disc", "cross", "square")


@dataclass(frozen=True, eq=False)
class Case:
    """The transducers and the samples of one of the four rows of Figure 6.

    points: [m], shape (M, 3), row by row from the region's first corner.
    """

    name: str
    array: pc.Array
    points: Floats


@dataclass(frozen=True)
class Spectrum:
    """The singular values s_1 >= ... >= s_N of a case's B.

    samples, transducers: M, N. rank: number of singular values above `CUT` s_1. condition: s_1 / s_N, infinite if
    rank < N. kept: s_1 / s_rank, the condition number after the cut.
    """

    case: str
    samples: int
    transducers: int
    rank: int
    condition: float
    kept: float


@dataclass(frozen=True, eq=False)
class Outcome:
    """One pattern, solved in one case.

    target, amplitude: target and achieved |p| [Pa], shape (41, 41). correlation: of the two. error: ||p - target|| /
    ||target||. maximum: of |p| [Pa].
    """

    case: str
    pattern: str
    target: Floats
    amplitude: Floats
    correlation: float
    error: float
    maximum: float


@dataclass(frozen=True)
class Experiment:
    """All results of section 5: spectra by case, outcomes by (pattern, case)."""

    spectra: dict[str, Spectrum]
    outcomes: dict[tuple[str, str], Outcome]


def grid() -> tuple[Floats, Floats]:
    """Return (u, v), each of shape (41, 41), in -1..1 over a region; v grows with the row."""
    u = np.linspace(-1.0, 1.0, COUNT)
    v, u = np.meshgrid(u, u, indexing="ij")
    return u, v


def pattern(name: str) -> Floats:
    """Return the target |p| [Pa] of Figure 5, 0 or 1, shape (41, 41). Raises ArgumentError.

    The samples at r = 0.3 are outside the disc, whichever way rounding moves them.
    """
    u, v = grid()
    r, side = np.hypot(u, v), np.maximum(np.abs(u), np.abs(v))
    shapes = {
        "ring": np.abs(r - 0.5) < 0.08,
        "disc": r < 0.3 - EDGE,
        "cross": ((np.abs(u) < 0.06) | (np.abs(v) < 0.06)) & (side < 0.6),
        "square": np.abs(side - 0.5) < 0.08,
    }
    if name not in shapes:
        raise ArgumentError("name", f"must be one of {', '.join(PATTERNS)}, not {name!r}")
    return shapes[name].astype(np.float64)


def case(name: str, distance: float = DISTANCE) -> Case:
    """Return a case of Figure 6 by name, with its region's centre at height `distance` [m].

    Region 1 is parallel to the xy-plane, region 2 to the yz-plane. Arrangement a is 200 mm in x by 400 mm in y (the
    paper's text says 20 mm by 40 mm). Arrangement b is the same, folded about the x axis. Raises ArgumentError.
    """
    if name not in CASES:
        raise ArgumentError("name", f"must be one of {', '.join(CASES)}, not {name!r}")
    u, v = grid()
    axes = (u, v, 0.0 * u) if name[0] == "1" else (0.0 * u, u, v)
    points = HALF * np.stack(axes, axis=-1).reshape(-1, 3) + (0.0, 0.0, distance)
    flat = pc.lattice(0.2, 0.4)
    return Case(name, flat if name[1] == "a" else flat.fold("x", math.radians(45.0)), points)


def spectrum(case: Case) -> Spectrum:
    """Return rank and condition number of a case's B, from its singular values."""
    B = pc.matrix(case.array, case.points, MEDIUM)
    s = linalg.svdvals(B)
    rank = int((s > CUT * s[0]).sum())
    condition = float(s[0] / s[-1]) if rank == len(s) else math.inf
    kept = float(s[0] / s[rank - 1])
    return Spectrum(case.name, len(case.points), len(case.array), rank, condition, kept)


def solve(case: Case, name: str, cut: float = CUT) -> Outcome:
    """Solve for the pattern `name` in a case: least squares, target phase 0, no limit on the gains.

    cut: singular values below this fraction of the largest count as zero. Raises ArgumentError.
    """
    target = pattern(name)
    solution = pc.solve(
        case.array,
        case.points,
        target.ravel(),
        phases=0.0,
        solver=pc.solver("pseudo-inverse", rcond=cut),
        limits=pc.Limits(gain=None),
        medium=MEDIUM,
        precision="double",
    )
    amplitude = np.abs(solution.sound_pressure).astype(np.float64).reshape(target.shape)
    return Outcome(
        case.name,
        name,
        target,
        amplitude,
        correlation(amplitude, target),
        solution.error,
        float(amplitude.max()),
    )


def correlation(a: Floats, b: Floats) -> float:
    """Return Pearson's correlation of two maps of the same shape."""
    return float(np.corrcoef(a.ravel(), b.ravel())[0, 1])


def run(advance: Callable[[], object] = lambda: None) -> Experiment:
    """Run the whole experiment. advance: called after each of the `len(CASES) * (1 + len(PATTERNS))` steps."""
    spectra: dict[str, Spectrum] = {}
    outcomes: dict[tuple[str, str], Outcome] = {}
    for place in map(case, CASES):
        spectra[place.name] = spectrum(place)
        advance()
        for name in PATTERNS:
            outcomes[name, place.name] = solve(place, name)
            advance()
    return Experiment(spectra, outcomes)
