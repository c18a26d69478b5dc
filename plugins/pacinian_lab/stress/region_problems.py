"""Hard regions: samples of one surface, whose phases depend on each other."""

from __future__ import annotations

import functools
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from pacinian.acoustics.air import Air
from pacinian.acoustics.array import autd
from pacinian.errors import PointOnTransducer
from pacinian.region_numbers import BESIDE, ISOLATED
from pacinian.solving.limits import Limits
from pacinian.testing.shapes import (
    Shape,
    make_finger,
    make_line,
    make_points,
    make_ring,
    make_square,
    of,
)
from pacinian_lab.stress.case import Case
from pacinian_lab.stress.problem_parts import (
    HEIGHT,
    NO_LIMIT,
    SMALL_ARRAY,
    compute_asked,
    scatter_points,
)

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from pacinian.types import Floats
    from pacinian_lab.stress.case import Before

LEVELS = {0.3: "", 6.0: ", too strong"}


def regions() -> Iterator[Case]:
    """Lines, bent surfaces, regions that touch, overlap or degenerate; with limits, moves and extremes."""
    for what, shape in shapes().items():
        yield from _four(what, shape)
    yield from _awkward_places()
    yield from _strengths()
    yield from _limits()
    yield from _sessions()
    yield from _many()


# ---------------------------------------------------------------------- shapes


@functools.cache
def shapes() -> dict[str, Shape]:
    """Regions by name."""
    disc, four, right = make_ring(0.0, 0.006), make_square(4), np.array([1.0, 0.0, 0.0])
    alone, lone = scatter_points(3, seed=1, height=0.11), np.full(3, ISOLATED)
    around = make_ring(0.012, 0.016)
    mixed = of(disc, four + 0.02 * right)
    upright = make_points(four[:, 0], 0.002, HEIGHT + four[:, 1])
    return {
        "a line": of(make_line(9)),
        "a square": of(make_square(5)),
        "half of a cylinder": of(make_finger()),
        "a disc in a ring": of(make_ring(0.0, 0.004), make_ring(0.009, 0.012)),
        "touching": of(four - 0.006 * right, four + 0.006 * right),
        "sharing an edge": of(four - 0.0045 * right, four + 0.0045 * right),
        "overlapping": of(four, four + 0.00451 * right),
        "the same samples twice": of(disc, disc),
        "each sample twice": of(np.repeat(disc, 2, axis=0)),
        "each sample twice, 1e-9 m apart": of(np.concatenate([disc, disc + 1e-9 * right])),
        "1e-5 m apart": of(make_square(6, spacing=1e-5)),
        "one sample": of(disc[:1]),
        "two samples": of(make_line(2)),
        "two samples in one place": of(np.repeat(disc[:1], 2, axis=0)),
        "two samples a wavelength apart": of(make_line(2, spacing=0.0085)),
        "all in one place": of(np.repeat(disc[:1], 40, axis=0)),
        "one behind another": of(disc, disc + np.array([0.0, 0.0, 0.0085])),
        "upright": of(upright),
        "of uneven spacing": of(
            np.concatenate([make_square(5), make_square(4, 0.035, spacing=0.0085)])
        ),
        "every sample a region": of(*(q[None] for q in disc)),
        "with isolated points": Shape(
            np.concatenate([mixed.points, alone]), np.append(mixed.regions, lone)
        ),
        "with points beside": Shape(
            np.concatenate([disc, around]), np.repeat([0, BESIDE], [len(disc), len(around)])
        ),
    }


def _case(what: str, shape: Shape, level: float = 0.3) -> Case:
    q, own = shape.points, shape.regions != BESIDE
    t = compute_asked(SMALL_ARRAY, q, level, own)
    return Case(f"regions: {what}", SMALL_ARRAY, q, t, regions=shape.regions)


def _four(what: str, shape: Shape) -> Iterator[Case]:
    """Within reach, beyond it, as strong as possible, in double precision."""
    for level, how in LEVELS.items():
        yield _case(what + how, shape, level)
    case = _case(what, shape)
    yield replace(case, name=f"{case.name}, max", scale="max")
    yield replace(case, name=f"{case.name}, double", precision="double")


# ---------------------------------------------------------------------- where, and how strong


def _awkward_places() -> Iterator[Case]:
    """Behind the array, in its plane, on it, 10 m wide."""
    four, even = make_square(4), Air(attenuation="none")
    unit, below = autd(), [1.0, 1.0, -1.0]
    sides = four * np.where(np.arange(16)[:, None] < 8, 1.0, below)
    for what, q in (("behind", four * below), ("half behind", sides)):
        case = Case(f"regions: {what}", unit, q, np.full(16, 20.0), regions=np.zeros(16, np.int64))
        yield case
        yield replace(case, name=f"{case.name}, max", scale="max")
        yield replace(case, name=f"{case.name}, no limit", limits=NO_LIMIT)
    both = np.concatenate([four, four * below])
    yield _case("before and behind", Shape(both, np.zeros(32, np.int64)))
    over = SMALL_ARRAY.positions[14]  # a transducer half way between two of these samples
    for above in (0.0, 1.1e-6, 1e-4, 1e-3):
        flat = over + make_square(4, z=above)
        case = _case(f"{above:g} m above the plane", of(flat))
        case = replace(case, amplitudes=np.full(16, 20.0))
        yield case
        yield replace(case, name=f"{case.name}, max", scale="max")
        yield replace(case, name=f"{case.name}, double", precision="double")
    on = np.concatenate([four, over[None]])
    case = replace(_case("on a transducer", of(four)), points=on, amplitudes=np.full(17, 5.0))
    case = replace(case, regions=np.zeros(17, np.int64))
    yield replace(case, refused=PointOnTransducer)
    yield replace(case, name=f"{case.name}, no attenuation", medium=even)
    wide = np.stack(np.meshgrid(*[np.linspace(-5.0, 5.0, 6)] * 2), axis=-1).reshape(-1, 2)
    yield from _four("10 m wide", of(np.c_[wide, np.full(36, 0.5)]))
    yield _case("a line 10 m long", of(make_line(41, spacing=0.25)))


def _strengths() -> Iterator[Case]:
    """Silence, partial silence, 1e-30 to 1e30 Pa, up to a million times beyond reach."""
    two = shapes()["touching"]
    M = len(two.points)
    case = _case("", two)
    asks: dict[str, Floats] = {
        "zeros": np.zeros(M),
        "one region silent": np.where(two.regions == 0, 5.0, 0.0),
        "half of the samples silent": np.where(np.arange(M) % 2, 5.0, 0.0),
        "one sample asks": np.where(np.arange(M) == 3, 5.0, 0.0),
        "0.1 to 1": np.linspace(0.5, 5.0, M),
        "1e-30 beside 1e30 Pa": np.where(two.regions == 0, 1e-30, 1e30),
        "1e-30 to 1e30 Pa": np.geomspace(1e-30, 1e30, M).astype(np.float64),
        "denormals": np.full(M, 5e-324),
    }
    asks |= {f"{10.0**n:g} Pa": np.full(M, 10.0**n) for n in range(-30, 31, 10)}
    for what, t in asks.items():
        for how, changes in (
            ("", {}),
            (", no limit", {"limits": NO_LIMIT}),
            (", max", {"scale": "max"}),
        ):
            given: dict[str, Any] = changes
            yield replace(case, name=f"regions: {what}{how}", amplitudes=t, **given)
    some = {name: shapes()[name] for name in ("a square", "touching", "with isolated points")}
    for level in (0.3, 1.0, 3.0, 30.0, 1e6):
        for what, shape in some.items():
            yield _case(f"level {level:g}, {what}", shape, level)


def _limits() -> Iterator[Case]:
    """Limits of every kind, deadlines, given phases, double precision."""
    shape = shapes()["with isolated points"]
    quiet = np.array([[0.0, 0.0, 0.07], [0.02, 0.0, 0.07]])
    kinds: dict[str, dict[str, Any]] = {
        "gain 1e-6": {"gain": 1e-6},
        "gain 1e6": {"gain": 1e6},
        "gain none": {"gain": None},
        "power 1e-12": {"power": 1e-12},
        "power 1": {"power": 1.0},
        "power only": {"gain": None, "power": 5.0},
        "quiet": {"quiet": (quiet, 1.0)},
        "quiet, silent": {"quiet": (quiet, 0.0)},
        "quiet on a sample": {"quiet": (shape.points[:1], 1.0)},
        "exact": {"exact": [0, 3]},
        "exact, an isolated point": {"exact": [-1]},
        "all": {"gain": 0.8, "power": 9.0, "quiet": (quiet, 2.0), "exact": [1]},
    }
    for kind, given in kinds.items():
        for level in (0.3, 3.0):
            case = replace(_case(f"{kind}, level {level:g}", shape, level), limits=Limits(**given))
            yield case
            if not case.limits.solver_limits and (case.limits.gain or case.limits.power):
                yield replace(case, name=f"{case.name}, max", scale="max")
    M = len(shape.points)
    tilt = 100.0 * shape.points[:, 0]
    phases: dict[str, Floats] = {
        "phases given": tilt,
        "phases half given": np.where(np.arange(M) % 2, tilt, np.nan),
        "phases of one region given": np.where(shape.regions == 0, tilt, np.nan),
        "phases opposed": np.where(np.arange(M) % 2, np.pi, 0.0),
        "phases of 1e300 rad": np.full(M, 1e300),
    }
    for what, phi in phases.items():
        for level in (0.3, 6.0):
            yield replace(_case(f"{what}, level {level:g}", shape, level), phases=phi)
    for deadline in (0.0, 0.05):
        for level in (0.3, 6.0):
            for how, changes in (("", {}), (", max", {"scale": "max"})):
                options: dict[str, Any] = changes
                name = f"{deadline:g} s, level {level:g}{how}"
                yield replace(_case(name, shape, level), deadline=deadline, **options)


def _sessions() -> Iterator[Case]:
    """Sessions in which samples move, come and go, and regions split, merge and change numbers."""
    wide, disc = make_square(7), make_ring(0.0, 0.006)
    M, whole = len(wide), np.zeros(len(wide), np.int64)
    halves = np.where(wide[:, 0] > 0.0, 1, 0)
    right = np.array([1.0, 0.0, 0.0])

    def t(q: Floats, level: float = 0.6) -> Floats:
        return compute_asked(SMALL_ARRAY, q, level)

    moved = [wide + 0.0004 * i * right for i in range(-12, 0)]
    inside = [wide[np.hypot(*(wide + 0.0004 * i * right).T[:2]) < 0.008] for i in range(-12, 1)]
    ways: dict[str, Sequence[Before]] = {
        "moves": [(q, t(q), whole) for q in moved],
        "a jump": [(wide + 0.03 * right, t(wide), whole)],
        "samples come and go": [(q, t(q), np.zeros(len(q), int)) for q in inside],
        "fewer before": [(disc, t(disc), np.zeros(len(disc), int))],
        "none before": [(wide, t(wide))],
        "another height, another number": [(wide + np.array([0.0, 0.0, 0.01]), t(wide), whole + 7)],
        "split": [(wide, t(wide), halves)],
        "other halves": [(wide, t(wide), 1 - halves), (wide, t(wide), 3 * halves - 1)],
        "silence": [(wide, np.zeros(M), whole)],
        "1e30 Pa": [(wide, np.full(M, 1e30), whole)],
        "1e-30 Pa": [(wide, np.full(M, 1e-30), whole)],
        "no points": [(wide[:0], [], [])],
        "a refusal": [(wide, t(wide), whole), (SMALL_ARRAY.positions[:2], [1.0, 1.0], [0, 0])],
    }
    for what, history in ways.items():
        for after, numbers in (("one", whole), ("two", halves), ("none", None)):
            name = f"{what}, then {after}"
            case = replace(_case(name, Shape(wide, whole), 0.6), regions=numbers)
            yield replace(case, history=history)


def _many() -> Iterator[Case]:
    """A thousand samples."""
    for what, shape in (
        ("a square", of(make_square(32, spacing=0.00125))),
        ("a line", of(make_line(1000, spacing=3e-5))),
        ("one place", of(np.repeat(make_square(1), 1000, axis=0))),
        ("one each", of(*(q[None] for q in make_square(32, spacing=0.00125)))),
    ):
        for deadline in (0.0, 0.05, 3.0):
            case = _case(f"{len(shape.points)} samples, {what}, {deadline:g} s", shape, 3.0)
            yield replace(case, deadline=deadline, slow=True)
