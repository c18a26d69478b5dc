"""Hard places: problems whose B is ill-conditioned, of low rank, or made of extreme numbers."""

from __future__ import annotations

import functools
import warnings
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from pacinian.acoustics.air import Air
from pacinian.acoustics.array import Array, CoincidentTransducers, autd, lattice
from pacinian.acoustics.pose import Pose
from pacinian.acoustics.transducer import T4010A1, Transducer
from pacinian.errors import PointOnTransducer
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

    from pacinian.types import ArrayLike


def coincident() -> Iterator[Case]:
    """Three pairs of points, 0 to 10 mm apart, with equal or opposite targets."""
    for spacing in (0.0, *(10.0**n for n in range(-9, -1))):
        q = scatter_points(6)
        q[3:] = q[:3] + np.array([spacing, 0.0, 0.0])
        asks: dict[str, tuple[ArrayLike, ArrayLike | None]] = {
            "the same": ([1, 2, 3] * 2, 0.0),
            "free": ([1, 2, 3] * 2, None),
            "half free": ([1, 2, 3] * 2, half(6)),
            "1 and 2": ([1, 1, 1, 2, 2, 2], None),
            "opposite phases": ([1, 2, 3] * 2, np.repeat([0.0, np.pi], 3)),
        }
        for what, (shares, phases) in asks.items():
            for level in (0.2, 3.0):
                name = f"coincident: {spacing:g} m apart, {what}, level {level:g}"
                yield Case(
                    name, SMALL_ARRAY, q, compute_asked(SMALL_ARRAY, q, level, shares), phases
                )
            name = f"coincident: {spacing:g} m apart, {what}, no limit"
            yield Case(
                name, SMALL_ARRAY, q, compute_asked(SMALL_ARRAY, q, 0.2, shares), phases, NO_LIMIT
            )


def touching() -> Iterator[Case]:
    """Points on a transducer, just above one, in the array's plane, behind it."""
    even, unit = Air(attenuation="none"), autd()
    for what, phases in PHASES.items():
        q = np.r_[scatter_points(3), SMALL_ARRAY.positions[[7]]]
        on = Case(f"touching: on a transducer, {what}", SMALL_ARRAY, q, np.full(4, 5.0), phases)
        yield replace(on, refused=PointOnTransducer)
        yield replace(on, name=f"{on.name}, no attenuation", medium=even)
        every = replace(
            on, points=SMALL_ARRAY.positions.copy(), amplitudes=np.full(36, 5.0), medium=even
        )
        yield replace(every, name=f"touching: on every transducer, {what}")
        for above in (0.0, 1.1e-6, 1e-5, 1e-4, 1e-3):
            flat = q * [1.0, 1.0, 0.0] + [0.003, 0.004, above]
            yield replace(on, name=f"touching: {above:g} m above the plane, {what}", points=flat)
            if above:
                near = np.r_[q[:3], q[3:] + np.array([0.0, 0.0, above])]
                case = replace(on, name=f"touching: {above:g} m above one, {what}", points=near)
                yield case
                yield replace(case, name=f"{case.name}, max", scale="max")
                yield replace(
                    case,
                    name=f"{case.name}, 1e30 Pa of 1e-6",
                    amplitudes=np.full(4, 1e30),
                    limits=Limits(gain=1e-6),
                )
        sides = scatter_points(4) * np.array([[1, 1, 1], [1, 1, -1]] * 2)
        for side, far, t in (
            ("behind", scatter_points(4) * [1, 1, -1], np.full(4, 50.0)),
            ("half behind", sides, np.full(4, 50.0)),
            ("half behind, asked there", sides, np.array([0.0, 50.0] * 2)),
        ):
            case = Case(f"touching: {side}, {what}", unit, far, t, phases)
            yield case
            yield replace(case, name=f"{case.name}, no limit", limits=NO_LIMIT)
            yield replace(case, name=f"{case.name}, max", scale="max")
        both = np.r_[scatter_points(3), scatter_points(3) * [1, 1, -1]]
        yield Case(f"touching: both sides, {what}", SMALL_ARRAY, both, np.full(6, 5.0), phases)


def mirror() -> Iterator[Case]:
    """Points in the array's plane of symmetry (case 2a of the paper), and pairs that mirror each other."""
    for what, phases in PHASES.items():
        for M in (4, 18, 40):
            rng = np.random.default_rng(M)
            q = np.c_[np.zeros(M), rng.uniform(-0.03, 0.03, M), rng.uniform(0.05, 0.15, M)]
            yield Case(
                f"mirror: {M} in the plane, {what}",
                SMALL_ARRAY,
                q,
                compute_asked(SMALL_ARRAY, q, 0.3),
                phases,
            )
    q = np.r_[scatter_points(4), scatter_points(4) * [-1, 1, 1]]
    for what, phases in {**PHASES, "opposite": np.repeat([0.0, np.pi], 4)}.items():
        yield Case(
            f"mirror: pairs, {what}", SMALL_ARRAY, q, compute_asked(SMALL_ARRAY, q, 0.3), phases
        )
    array, medium = lattice(0.2, 0.4), Air(attenuation="none")
    y, z = np.meshgrid(np.linspace(-0.2, 0.2, 21), np.linspace(0.01, 0.4, 21))
    q = np.stack([np.zeros_like(y), y, z], axis=-1).reshape(-1, 3)
    t = np.where(np.hypot(q[:, 1], q[:, 2] - 0.2) < 0.06, 100.0, 0.0)
    paper = Case("mirror: the paper's 2a", array, q, t, 0.0, NO_LIMIT, medium=medium)
    yield replace(paper, deadline=20.0, slow=True)


def duplicate() -> Iterator[Case]:
    """Several transducers at one place."""
    for what, phases in PHASES.items():
        for name, array in _make_duplicates().items():
            for M in (1, 5, 40):
                q = scatter_points(M)
                t = compute_asked(array, q, 0.3)
                yield Case(f"duplicate: {name}, {M} points, {what}", array, q, t, phases)


@functools.cache
def _make_duplicates() -> dict[str, Array]:
    r = SMALL_ARRAY.positions
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", CoincidentTransducers)
        return {
            "twice": Array(np.r_[r, r]),
            "all at one place": Array(np.zeros((36, 3))),
            "1e-9 m apart": Array(np.r_[r, r + np.array([1e-9, 0.0, 0.0])]),
        }


def rank() -> Iterator[Case]:
    """B of rank 0 to full, wide and tall."""
    for what, phases in PHASES.items():
        for N in (1, 2, 6, 36):
            array = Array(SMALL_ARRAY.positions[:N])
            for M in (1, 2, 6, 36, 60):
                q = scatter_points(M)
                name = f"rank: {N} transducers, {M} points, {what}"
                yield Case(name, array, q, compute_asked(array, q, 0.5), phases)
        for distinct in (1, 3, 9):
            q = np.resize(scatter_points(distinct), (12, 3))
            name = f"rank: {distinct} places, 12 points, {what}"
            yield Case(
                name, SMALL_ARRAY, q, compute_asked(SMALL_ARRAY, q, 0.5, np.arange(1, 13)), phases
            )
        away = np.where(np.arange(36) % 2, 1.0, -1.0)[:, None] * [0.0, 0.0, 1.0]
        for N in (3, 36):
            turned = Array(SMALL_ARRAY.positions[:N], away[:N], T4010A1)
            for M in (1, 5):
                q = scatter_points(M)
                for level in (3.0, 30.0):
                    name = (
                        f"rank: every second of {N} faces away, {M} points, level {level:g}, {what}"
                    )
                    yield Case(name, turned, q, compute_asked(turned, q, level), phases)
        below = scatter_points(5) * [1, 1, -1]
        yield Case(
            f"rank: 0, {what}",
            SMALL_ARRAY.replace_transducer(T4010A1),
            below,
            np.full(5, 1.0),
            phases,
        )


def condition() -> Iterator[Case]:
    """Five points in a row, spaced for condition numbers from 1e1 to 1e16."""
    mixed, one = np.arange(5.0) ** 2, Limits()
    for exponent in range(1, 17):
        q = row(10.0**exponent)
        t = compute_asked(SMALL_ARRAY, q, 0.3, [1, 2, 3, 2, 1])
        for what, phases, limits in (
            ("equal phases", 0.0, NO_LIMIT),
            ("mixed phases", mixed, NO_LIMIT),
            ("mixed phases, |g| <= 1", mixed, one),
            ("free phases, |g| <= 1", None, one),
        ):
            case = Case(f"condition: 1e{exponent}, {what}", SMALL_ARRAY, q, t, phases, limits)
            yield case
            yield replace(case, name=f"{case.name}, double", precision="double")


def offset() -> Iterator[Case]:
    """The array and its points 1 km and 1000 km from the origin; points far from the array."""
    for where in ((1000.0, 0.0, 0.0), (-1000.0, 2000.0, 500.0), (1e6, 0.0, 0.0)):
        pose = Pose(where)
        array = SMALL_ARRAY.transform(pose)
        for what, phases in PHASES.items():
            for M in (1, 6, 40):
                q = np.asarray(pose.points(scatter_points(M)))
                t = compute_asked(SMALL_ARRAY, scatter_points(M), 0.4)
                yield Case(f"offset: {where} m, {M} points, {what}", array, q, t, phases)
    q = scatter_points(3, height=9.6)
    yield Case("offset: points 9.6 m away", SMALL_ARRAY, q, compute_asked(SMALL_ARRAY, q, 0.4), 0.0)


def media() -> Iterator[Case]:
    """Attenuations, wavelengths and strengths far from those of air at 40 kHz."""
    q = scatter_points(4)
    for what, air, kind in (
        ("attenuation r^-2", Air(attenuation=2.0), Transducer()),
        ("no attenuation", Air(attenuation="none"), Transducer()),
        ("absorption 30/m", Air(absorption=30.0), Transducer()),
        ("absorption 1000/m", Air(absorption=1000.0), Transducer()),
        ("1 Hz", Air(), Transducer(frequency=1.0)),
        ("10 MHz", Air(), Transducer(frequency=1e7)),
        ("transducers of 1e-6 Pa", Air(), Transducer(pressure=1e-6)),
        ("transducers of 1e6 Pa", Air(), Transducer(pressure=1e6)),
    ):
        array = SMALL_ARRAY.replace_transducer(kind)
        t = compute_asked(array, q, 0.4, medium=air)
        for phase, phases in PHASES.items():
            yield Case(f"media: {what}, {phase}", array, q, t, phases, medium=air)
