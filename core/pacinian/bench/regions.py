"""Regions: how evenly they press at places that no solver was given, how much goes astray, and what it costs."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass
from statistics import median
from typing import TYPE_CHECKING, Literal, NamedTuple

import numpy as np

from pacinian.acoustics.air import Air
from pacinian.acoustics.pose import Pose
from pacinian.acoustics.pressure import radiation_pressure, sound_pressure
from pacinian.acoustics.propagation import field, matrix
from pacinian.bench.tables import plain_table, short
from pacinian.scene.objects import Surface, Volume
from pacinian.scene.sampling.sampler import Sampler
from pacinian.scene.scene import Scene
from pacinian.scene.shapes import Disc, Rectangle, Sphere
from pacinian.scene.shapes.height_map import HeightMap
from pacinian.scene.shapes.mesh import Mesh
from pacinian.session import Session

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from rich.table import Table

    from pacinian.acoustics.array import Array
    from pacinian.scene.objects import Object
    from pacinian.scene.sampling.samples import Samples
    from pacinian.scene.shapes.kinds import Shell
    from pacinian.types import Complexes, Flags, Floats, Longs

AIR = Air()
HEIGHT = 0.2  # [m] above the array
STEP = 0.001  # [m] between the places that are looked at
SIDE = 0.05  # [m] of the square around a flat shape in which they lie
NEAR, FAR = 0.003, 0.010  # [m] beside a shape in which is looked for what presses there
HOLE = 0.5  # of what was asked: less is a hole
STRENGTHS = (0.25, 0.5, 1.0)  # of the strongest even field
MOVED = 0.0004  # [m] from one warm solve to the next
WARM = 9  # of these
ENOUGH = 100_000  # samples: no budget
FREE = {"foci, 8.5 mm apart": 0.0085, "foci, 4.25 mm apart": 0.00425}
SWEPT, OURS = "one focus, swept", "regions"


@dataclass(frozen=True, eq=False)
class Shape:
    """What is asked, and where it is looked at.

    items: objects of pressure 1 Pa, or a share of it. places: (K, 3) [m], and what is asked there, (K,) [Pa].
    beside: places 3 to 10 mm beside it, in its plane, (J, 3) [m]; none for volumes.
    """

    items: tuple[Object, ...]
    places: Floats
    asked: Floats
    beside: Floats

    def samples(self, array: Array, spacing: float | None = None) -> Samples:
        """As a loop samples it; or `spacing` [m] apart."""
        sampler = Sampler(ENOUGH, spacing)
        sampler.prepare(array, AIR)
        return sampler.sample(Scene(self.items))


class Row(NamedTuple):
    """How one way to make a shape did, at a strength: a share of the strongest even field.

    pressure: asked [Pa]. samples: how many. force: over what was asked. rms: of the difference, over that of what
    was asked. holes: share of the places below half. beside: highest pressure 3 to 10 mm beside it, over the mean
    asked, NaN for volumes. saturation: share of the transducers at their limit. cold_ms, warm_ms: a solve from
    nothing; one after all has moved by 0.4 mm, with B. build_ms: B alone.
    """

    shape: str
    way: str
    strength: float
    pressure: float
    samples: int
    force: float
    rms: float
    holes: float
    beside: float
    saturation: float
    status: str
    cold_ms: float
    warm_ms: float
    build_ms: float


def _flat(inside: Callable[[Floats, Floats], Flags]) -> tuple[Floats, Floats]:
    """Places in a flat shape of the xy-plane, off every lattice, and beside it: (K, 3), (J, 3) [m]."""
    from scipy.spatial import KDTree

    side = np.arange(-SIDE / 2.0, SIDE / 2.0, STEP) + 0.37 * STEP
    X, Y = (each.ravel() for each in np.meshgrid(side, side))
    every, own = np.stack([X, Y, 0.0 * X], axis=-1), inside(X, Y)
    away = KDTree(every[own]).query(every)[0]
    return every[own], every[(away > NEAR) & (away < FAR)]


def _plate(shape: Shell, inside: Callable[[Floats, Floats], Flags], pose: Pose) -> Shape:
    """A flat shape at a pose."""
    places, beside = _flat(inside)
    item = Surface(shape=shape, pose=pose, radiation_pressure=1.0)
    return Shape((item,), pose.points(places), np.ones(len(places)), pose.points(beside))


def _mesh(inside: Callable[[Floats, Floats], Flags]) -> Mesh:
    """Triangles of a flat shape, of squares of 1 mm."""
    n = round(SIDE / STEP)
    x = STEP * (np.arange(n + 1) - n / 2.0)
    X, Y = np.meshgrid((x[1:] + x[:-1]) / 2.0, (x[1:] + x[:-1]) / 2.0)
    row, column = np.nonzero(inside(X, Y))
    a = row * (n + 1) + column
    b, c, d = a + 1, a + n + 2, a + n + 1
    faces = np.concatenate([np.stack([a, b, c], axis=-1), np.stack([a, c, d], axis=-1)])
    used, faces = np.unique(faces, return_inverse=True)
    vertices = np.stack([x[used % (n + 1)], x[used // (n + 1)], 0.0 * used], axis=-1)
    corners = [(int(a), int(b), int(c)) for a, b, c in faces.reshape(-1, 3)]
    return Mesh(vertices=tuple(vertices.tolist()), faces=tuple(corners))


def _turned(degrees: float) -> Pose:
    half = math.radians(degrees) / 2.0
    return Pose((0.0, 0.0, HEIGHT), (math.sin(half), 0.0, 0.0, math.cos(half)))


def _ball(radius: float, felt: Literal["shell", "interior"]) -> Shape:
    """The shell of a ball, or all of it."""
    rng = np.random.default_rng(0)
    away = rng.normal(size=(4000, 3))
    away /= np.sqrt((away**2).sum(axis=1, keepdims=True))
    away *= radius * (rng.uniform(size=(4000, 1)) ** (1.0 / 3.0) if felt == "interior" else 1.0)
    pose = _turned(0.0)
    item = Volume(shape=Sphere(radius), pose=pose, radiation_pressure=1.0, felt=felt)
    return Shape((item,), pose.points(away), np.ones(4000), np.empty((0, 3)))


def _two() -> Shape:
    """Two discs, the second half as strong."""
    places, beside = _flat(lambda x, y: np.hypot(np.abs(x) - 0.015, y) < 0.008)
    items, pose = [], _turned(0.0)
    for x, pressure in ((-0.015, 1.0), (0.015, 0.5)):
        at = Pose((x, 0.0, HEIGHT))
        items.append(Surface(shape=Disc(0.008), pose=at, radiation_pressure=pressure))
    asked = np.where(places[:, 0] < 0.0, 1.0, 0.5)
    return Shape(tuple(items), pose.points(places), asked, pose.points(beside))


def _bowl() -> Shape:
    """A ball's lower side, from below."""
    places, _ = _flat(lambda x, y: np.maximum(np.abs(x), np.abs(y)) < 0.015)
    side, depth = np.linspace(-1.0, 1.0, 31) ** 2, 0.006
    pose = _turned(0.0)
    shape = HeightMap(heights=np.add.outer(side, side) / 2.0, width=0.03, height=0.03, depth=depth)
    places[:, 2] = depth * (places[:, 0] ** 2 + places[:, 1] ** 2) / (2.0 * 0.015**2)
    item = Surface(shape=shape, pose=pose, radiation_pressure=1.0)
    return Shape((item,), pose.points(places), np.ones(len(places)), np.empty((0, 3)))


def _rectangle(width: float, height: float, turned: float = 0.0) -> Shape:
    return _plate(
        Rectangle(width, height),
        lambda x, y: (np.abs(x) < width / 2.0) & (np.abs(y) < height / 2.0),
        _turned(turned),
    )


def _drawn(inside: Callable[[Floats, Floats], Flags]) -> Shape:
    return _plate(_mesh(inside), inside, _turned(0.0))


def _letter_h(x: Floats, y: Floats) -> Flags:
    upright = (np.abs(np.abs(x) - 0.012) < 0.005) & (np.abs(y) < 0.02)
    return upright | ((np.abs(x) < 0.012) & (np.abs(y) < 0.005))


def _letter_s(x: Floats, y: Floats) -> Flags:
    """Of five strokes, 7 mm wide."""
    across = (np.abs(x) < 0.0125) & (np.minimum(np.abs(y), np.abs(np.abs(y) - 0.014)) < 0.0035)
    left = (np.abs(x + 0.009) < 0.0035) & (y > 0.0) & (y < 0.014)
    return across | left | ((np.abs(x - 0.009) < 0.0035) & (y < 0.0) & (y > -0.014))


SHAPES: dict[str, Callable[[], Shape]] = {
    "disc, 30 mm": lambda: _plate(Disc(0.015), lambda x, y: np.hypot(x, y) < 0.015, _turned(0.0)),
    "disc, 8 mm": lambda: _plate(Disc(0.004), lambda x, y: np.hypot(x, y) < 0.004, _turned(0.0)),
    "ring, 24 to 40 mm": lambda: _drawn(lambda x, y: np.abs(np.hypot(x, y) - 0.016) < 0.004),
    "rectangle, 43 x 31 mm": lambda: _rectangle(0.043, 0.031),
    "strip, 8 x 30 mm": lambda: _rectangle(0.008, 0.03),
    "square, 40 mm": lambda: _rectangle(0.04, 0.04),
    "letter H": lambda: _drawn(_letter_h),
    "letter S": lambda: _drawn(_letter_s),
    "two discs, one half as strong": _two,
    "square, tilted by 30 degrees": lambda: _rectangle(0.03, 0.03, 30.0),
    "plate, upright": lambda: _rectangle(0.03, 0.03, 90.0),
    "bowl": _bowl,
    "shell of a ball, radius 12 mm": lambda: _ball(0.012, "shell"),
    "solid ball, radius 8 mm": lambda: _ball(0.008, "interior"),
}


def measure(
    array: Array,
    name: str,
    solvers: tuple[str, ...] = (),
    strengths: tuple[float, ...] = STRENGTHS,
) -> Iterator[Row]:
    """A shape at each strength: by regions, by other `solvers` on the same samples, by foci."""
    shape = SHAPES[name]()
    strongest = _strongest(array, shape)
    for strength in strengths:
        for way in (OURS, *solvers, *FREE, SWEPT):
            yield _row(array, name, shape, way, strength, strength * strongest)


def table(name: str, rows: Sequence[Row]) -> Table:
    """The rows of one shape."""
    head = [
        "strength", "asked\n[Pa]", "samples", "force\n[%]", "rms\n[%]", "holes\n[%]", "beside\n[%]",
        "at limit\n[%]", "cold\n[ms]", "warm\n[ms]", "B alone\n[ms]", "status",
    ]  # fmt: skip
    lines = [
        [
            f"{row.strength:g}", row.way, short(row.pressure), str(row.samples),
            f"{100 * row.force:.1f}", f"{100 * row.rms:.1f}", f"{100 * row.holes:.0f}",
            "" if math.isnan(row.beside) else f"{100 * row.beside:.0f}", f"{100 * row.saturation:.1f}",
            *("" if math.isnan(ms) else short(ms) for ms in (row.cold_ms, row.warm_ms, row.build_ms)),
            row.status,
        ]
        for row in rows
    ]  # fmt: skip
    return plain_table(name, [head[0], "made by", *head[1:]], lines)


def pressures(array: Array, gains: Complexes, places: Floats) -> Floats:
    """Radiation pressure at places (K, 3), (K,) [Pa], in double precision; the mean over several gains."""
    made = [radiation_pressure(field(array, g, places, AIR), AIR) for g in np.atleast_2d(gains)]
    return np.asarray(np.mean(made, axis=0))


def _row(array: Array, name: str, shape: Shape, way: str, strength: float, pressure: float) -> Row:
    asked = pressure * shape.asked
    if way == SWEPT:
        gains = _swept(array, shape, pressure)
        samples, status, times = len(gains), "", (math.nan, math.nan, math.nan)
    else:
        chosen, regions = _asked(array, shape, way)
        t, q = sound_pressure(pressure * chosen.radiation_pressure, AIR), chosen.positions
        session = Session(array, AIR, _solver(way))
        session.solve(q, t, regions=regions)
        session.forget()
        begin = time.perf_counter()
        solution = session.solve(q, t, regions=regions)
        cold = time.perf_counter() - begin
        gains, samples, status = solution.gains, len(q), session.certify(solution.gains).status.name
        warm: list[float] = []
        built: list[float] = []
        for step in range(1, WARM + 1):
            moved = q + MOVED * step * np.array([1.0, 0.0, 0.0])
            begin = time.perf_counter()
            session.solve(moved, t, regions=regions)
            warm.append(time.perf_counter() - begin)
        for step in range(WARM):
            begin = time.perf_counter()
            session.propagator.place(q + MOVED * step)
            built.append(time.perf_counter() - begin)
        times = 1e3 * cold, 1e3 * median(warm), 1e3 * median(built)
    P, beside = (pressures(array, gains, where) for where in (shape.places, shape.beside))
    return Row(
        name, way, strength, pressure, samples,
        float(P.sum() / asked.sum()),
        float(np.sqrt(((P - asked) ** 2).mean() / (asked**2).mean())),
        float((HOLE * asked > P).mean()),
        float(beside.max() / asked.mean()) if len(beside) else math.nan,
        float((np.abs(gains) >= 1.0 - 1e-5).mean()),
        status, *times,
    )  # fmt: skip


def _asked(array: Array, shape: Shape, way: str) -> tuple[Samples, Longs | None]:
    """The samples of one way, and their regions."""
    spacing = FREE.get(way)
    samples = shape.samples(array, spacing)
    return samples, None if spacing else samples.regions


def _solver(way: str) -> str:
    return "auto" if way == OURS or way in FREE else way


def _strongest(array: Array, shape: Shape) -> float:
    """The most that the array can make evenly of it [Pa], asked of 1 Pa."""
    samples = shape.samples(array)
    t = sound_pressure(samples.radiation_pressure, AIR)
    session = Session(array, AIR)
    solution = session.solve(samples.positions, t, regions=samples.regions, scale="max")
    return float(
        np.vdot(solution.sound_pressure, solution.sound_pressure).real / np.vdot(t, t).real
    )


def _swept(array: Array, shape: Shape, pressure: float) -> Complexes:
    """Gains of one focus at each place in turn, (K, N), as strong as makes the force, or full drive."""
    samples = shape.samples(array, FREE["foci, 4.25 mm apart"])
    B = matrix(array, samples.positions, AIR)
    gains = B.conj() / np.abs(B)  # full drive, all in phase there
    share = samples.radiation_pressure / samples.radiation_pressure.max()
    gains = gains * np.sqrt(share)[:, None]
    made = pressures(array, gains, shape.places).sum()
    return np.asarray(gains * min(1.0, math.sqrt(pressure * shape.asked.sum() / made)))
