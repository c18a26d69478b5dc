"""The shapes of the benchmark: the request, the places of measurement, and the picture of each."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

from pacinian.acoustics.pose import Pose
from pacinian.scene.objects import Surface, Volume
from pacinian.scene.sampling.sampler import Sampler
from pacinian.scene.scene import Scene
from pacinian.scene.shapes import Disc, Rectangle, Sphere
from pacinian.scene.shapes.height_map import HeightMap
from pacinian.scene.shapes.mesh import Mesh
from pacinian.scene.shapes.texture import Texture, grating
from pacinian_lab.solvers.problems import AIR

if TYPE_CHECKING:
    from collections.abc import Callable

    from pacinian.acoustics.array import Array
    from pacinian.scene.objects import Object
    from pacinian.scene.sampling.samples import Samples
    from pacinian.scene.shapes.shape_types import Shell
    from pacinian.types import Flags, Floats

    Inside = Callable[[Floats, Floats], Flags]
    Factor = Callable[[Floats, Floats], Floats]

HEIGHT = 0.2  # [m] above the array
PLACE_SPACING = 0.001  # [m] between the places where pressure is measured
MESH_SPACING = 0.001  # [m] side of the squares of which a mesh is made
PICTURE_SPACING = 0.00025  # [m] between the points of a picture
SIDE = 0.05  # [m] of the square around a flat shape, which contains the shape and `beside`
# [m] distances from a shape between which `beside` is measured
BESIDE_FROM, BESIDE_TO = 0.003, 0.010
BALL_PLACES = 4000  # random places on or in a ball
MAX_SAMPLES = 100_000  # more than any shape has, so in effect no budget


@dataclass(frozen=True, eq=False)
class View:
    """A surface through a shape, unrolled into a picture.

    points: (R, C, 3) [m]. asked: fraction of the shape's pressure that is requested there, (R, C). sides: left,
    right, bottom and top of the picture [m]. labels: of its two axes. title: names the surface.
    """

    points: Floats
    asked: Floats
    sides: tuple[float, float, float, float]
    labels: tuple[str, str] = ("x [mm]", "y [mm]")
    title: str = ""


@dataclass(frozen=True, eq=False)
class Shape:
    """Objects, and the places where their pressure is measured.

    items: objects of at most 1 Pa. places: (K, 3) [m], asked: the pressure requested there, (K,) [Pa]. beside: places
    3 to 10 mm beside a flat shape, in its plane, (J, 3) [m]; empty for others. view: its picture.
    """

    items: tuple[Object, ...]
    places: Floats
    asked: Floats
    beside: Floats
    view: View

    def samples(self, array: Array, spacing: float | None = None) -> Samples:
        """Sample the shape as the rendering loop does, or with samples `spacing` [m] apart."""
        sampler = Sampler(MAX_SAMPLES, spacing)
        sampler.prepare(array, AIR)
        return sampler.sample(Scene(self.items))


def _ones(x: Floats, y: Floats) -> Floats:
    return np.ones(np.broadcast(x, y).shape)


def _turn(degrees: float) -> Pose:
    """Return a pose tilted about x, 0.2 m above the array."""
    return Pose((0.0, 0.0, HEIGHT)).rotate("x", math.radians(degrees))


def _lattice(inside: Inside) -> tuple[Floats, Floats]:
    """Return places in a flat shape of the xy-plane, off the samplers' lattices, and beside it: (K, 3), (J, 3) [m]."""
    from scipy.spatial import KDTree

    side = np.arange(-SIDE / 2.0, SIDE / 2.0, PLACE_SPACING) + 0.37 * PLACE_SPACING
    X, Y = (each.ravel() for each in np.meshgrid(side, side))
    every, own = np.stack([X, Y, 0.0 * X], axis=-1), inside(X, Y)
    away = KDTree(every[own]).query(every)[0]
    return every[own], every[(away > BESIDE_FROM) & (away < BESIDE_TO)]


def _view(inside: Inside, factor: Factor, pose: Pose, lift: Factor | None = None) -> View:
    """Return a view of the plane of a flat shape, or of the surface z = lift(x, y) of its frame."""
    side = np.arange(-SIDE / 2.0, SIDE / 2.0, PICTURE_SPACING) + PICTURE_SPACING / 2.0
    X, Y = np.meshgrid(side, side)
    Z = 0.0 * X if lift is None else lift(X, Y)
    points = pose.points(np.stack([X, Y, Z], axis=-1).reshape(-1, 3)).reshape(*X.shape, 3)
    asked = np.where(inside(X, Y), factor(X, Y), 0.0)
    return View(points, asked, (-SIDE / 2.0, SIDE / 2.0, -SIDE / 2.0, SIDE / 2.0))


def _make_flat(
    items: tuple[Object, ...], inside: Inside, pose: Pose, factor: Factor = _ones
) -> Shape:
    places, beside = _lattice(inside)
    asked = factor(places[:, 0], places[:, 1])
    return Shape(
        items, pose.points(places), asked, pose.points(beside), _view(inside, factor, pose)
    )


def _make_plate(
    shape: Shell,
    inside: Inside,
    degrees: float = 0.0,
    texture: Texture | None = None,
    factor: Factor = _ones,
) -> Shape:
    pose = _turn(degrees)
    item = Surface(shape=shape, pose=pose, radiation_pressure=1.0, texture=texture)
    return _make_flat((item,), inside, pose, factor)


def _make_disc(radius: float) -> Shape:
    return _make_plate(Disc(radius), lambda x, y: np.hypot(x, y) < radius)


def _make_rectangle(
    width: float,
    height: float,
    degrees: float = 0.0,
    texture: Texture | None = None,
    factor: Factor = _ones,
) -> Shape:
    def inside(x: Floats, y: Floats) -> Flags:
        return (np.abs(x) < width / 2.0) & (np.abs(y) < height / 2.0)

    return _make_plate(Rectangle(width, height), inside, degrees, texture, factor)


def _make_grating(period: float) -> Shape:
    """Stripes on a square of 40 mm. The upper half of each period is pressed."""
    return _make_rectangle(
        0.04,
        0.04,
        texture=grating(period),
        factor=lambda x, y: np.where(np.mod(x, period) >= period / 2.0, 1.0, 0.0) + 0.0 * y,
    )


def _make_ramp(width: float, height: float) -> Shape:
    """A rectangle whose pressure rises linearly along x, from zero to full."""
    texture = Texture(values=((0.0, 1.0),), size=(2.0 * width, height), repeat=False)
    return _make_rectangle(
        width, height, texture=texture, factor=lambda x, y: 0.5 + x / width + 0.0 * y
    )


def _triangulate(inside: Inside) -> Mesh:
    """Return a mesh of a flat shape, made of squares of 1 mm."""
    n = round(SIDE / MESH_SPACING)
    x = MESH_SPACING * (np.arange(n + 1) - n / 2.0)
    X, Y = np.meshgrid((x[1:] + x[:-1]) / 2.0, (x[1:] + x[:-1]) / 2.0)
    row, column = np.nonzero(inside(X, Y))
    a = row * (n + 1) + column
    b, c, d = a + 1, a + n + 2, a + n + 1
    faces = np.concatenate([np.stack([a, b, c], axis=-1), np.stack([a, c, d], axis=-1)])
    used, faces = np.unique(faces, return_inverse=True)
    vertices = np.stack([x[used % (n + 1)], x[used // (n + 1)], 0.0 * used], axis=-1)
    corners = [(int(a), int(b), int(c)) for a, b, c in faces.reshape(-1, 3)]
    return Mesh(vertices=tuple(vertices.tolist()), faces=tuple(corners))


def _make_drawing(inside: Inside) -> Shape:
    return _make_plate(_triangulate(inside), inside)


def _covers_h(x: Floats, y: Floats) -> Flags:
    upright = (np.abs(np.abs(x) - 0.012) < 0.005) & (np.abs(y) < 0.02)
    return upright | ((np.abs(x) < 0.012) & (np.abs(y) < 0.005))


def _covers_s(x: Floats, y: Floats) -> Flags:
    """Five strokes, 7 mm wide."""
    across = (np.abs(x) < 0.0125) & (np.minimum(np.abs(y), np.abs(np.abs(y) - 0.014)) < 0.0035)
    left = (np.abs(x + 0.009) < 0.0035) & (y > 0.0) & (y < 0.014)
    return across | left | ((np.abs(x - 0.009) < 0.0035) & (y < 0.0) & (y > -0.014))


def _make_two_discs() -> Shape:
    items = tuple(
        Surface(shape=Disc(0.008), pose=Pose((x, 0.0, HEIGHT)), radiation_pressure=pressure)
        for x, pressure in ((-0.015, 1.0), (0.015, 0.5))
    )
    return _make_flat(
        items,
        lambda x, y: np.hypot(np.abs(x) - 0.015, y) < 0.008,
        _turn(0.0),
        lambda x, y: np.where(x < 0.0, 1.0, 0.5) + 0.0 * y,
    )


def _make_bowl() -> Shape:
    """A paraboloid over a square of 30 mm, 6 mm deep: the lower side of a ball."""

    def inside(x: Floats, y: Floats) -> Flags:
        return np.maximum(np.abs(x), np.abs(y)) < 0.015

    def lift(x: Floats, y: Floats) -> Floats:
        return 0.006 * (x**2 + y**2) / (2.0 * 0.015**2)

    places, _ = _lattice(inside)
    places[:, 2] = lift(places[:, 0], places[:, 1])
    side, pose = np.linspace(-1.0, 1.0, 31) ** 2, _turn(0.0)
    heights = np.add.outer(side, side) / 2.0
    shape = HeightMap(heights=heights, width=0.03, height=0.03, depth=0.006)
    item = Surface(shape=shape, pose=pose, radiation_pressure=1.0)
    return Shape(
        (item,), pose.points(places), np.ones(len(places)), np.empty((0, 3)),
        _view(inside, _ones, pose, lift),
    )  # fmt: skip


def _make_ball(radius: float, felt: Literal["shell", "interior"]) -> Shape:
    """The shell of a ball, or the whole ball."""
    rng = np.random.default_rng(0)
    places = rng.normal(size=(BALL_PLACES, 3))
    places /= np.sqrt((places**2).sum(axis=1, keepdims=True))
    if felt == "interior":
        places *= rng.uniform(size=(BALL_PLACES, 1)) ** (1.0 / 3.0)
    pose = _turn(0.0)
    item = Volume(shape=Sphere(radius), pose=pose, radiation_pressure=1.0, felt=felt)
    view = _unroll(radius) if felt == "shell" else _cut(radius)
    return Shape(
        (item,), pose.points(radius * places), np.ones(BALL_PLACES), np.empty((0, 3)), view
    )


def _unroll(radius: float) -> View:
    """Project a sphere onto a cylinder, which keeps areas equal. Right is along the equator, up is z."""
    half = math.pi * radius
    u = np.arange(-half, half, PICTURE_SPACING) + PICTURE_SPACING / 2.0
    v = np.arange(-radius, radius, PICTURE_SPACING) + PICTURE_SPACING / 2.0
    U, V = np.meshgrid(u, np.clip(v, -radius, radius))
    r = np.sqrt(radius**2 - V**2)
    points = np.stack([r * np.cos(U / radius), r * np.sin(U / radius), HEIGHT + V], axis=-1)
    labels = "along the equator [mm]", "height [mm]"
    return View(points, np.ones(U.shape), (-half, half, -radius, radius), labels, "unrolled")


def _cut(radius: float) -> View:
    """Return the vertical plane through a ball's centre."""
    side = np.arange(-2.0 * radius, 2.0 * radius, PICTURE_SPACING) + PICTURE_SPACING / 2.0
    X, Z = np.meshgrid(side, side)
    points = np.stack([X, 0.0 * X, HEIGHT + Z], axis=-1)
    asked = np.where(np.hypot(X, Z) < radius, 1.0, 0.0)
    end = 2.0 * radius
    labels = "x [mm]", "height [mm]"
    return View(points, asked, (-end, end, -end, end), labels, "upright cut")


SHAPES: dict[str, Callable[[], Shape]] = {
    "disc, 30 mm": lambda: _make_disc(0.015),
    "disc, 8 mm": lambda: _make_disc(0.004),
    "ring, 24 to 40 mm": lambda: _make_drawing(lambda x, y: np.abs(np.hypot(x, y) - 0.016) < 0.004),
    "rectangle, 43 x 31 mm": lambda: _make_rectangle(0.043, 0.031),
    "strip, 8 x 30 mm": lambda: _make_rectangle(0.008, 0.03),
    "square, 40 mm": lambda: _make_rectangle(0.04, 0.04),
    "letter H": lambda: _make_drawing(_covers_h),
    "letter S": lambda: _make_drawing(_covers_s),
    "two discs, one half as strong": _make_two_discs,
    "ramp, 43 x 31 mm": lambda: _make_ramp(0.043, 0.031),
    "grating, period 20 mm": lambda: _make_grating(0.02),
    "grating, period 10 mm": lambda: _make_grating(0.01),
    "grating, period 5 mm": lambda: _make_grating(0.005),
    "square, tilted by 30 degrees": lambda: _make_rectangle(0.03, 0.03, 30.0),
    "plate, upright": lambda: _make_rectangle(0.03, 0.03, 90.0),
    "bowl": _make_bowl,
    "shell of a ball, radius 12 mm": lambda: _make_ball(0.012, "shell"),
    "solid ball, radius 8 mm": lambda: _make_ball(0.008, "interior"),
}
"""Shapes by name, in the order of the tables."""
