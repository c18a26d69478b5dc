from __future__ import annotations

import math
import threading
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial import KDTree

import pacinian as pc
from pacinian.scene.shapes.sdf import gradient, sample_interior

from ..tools import mesh_of

if TYPE_CHECKING:
    from collections.abc import Callable

    from hypothesis.strategies import DrawFn

    from pacinian.types import Floats

Size = tuple[float, float, float]  # [m]


class Kind(NamedTuple):
    """A kind of shape, made from three sizes, with independently known properties."""

    name: str
    make: Callable[[Size], Any]
    # signed distance of points [m], negative inside; unsigned for a flat shape
    distance: Callable[[Floats, Size], Floats]
    area: Callable[[Size], float]
    number: tuple[float, float]  # bounds of samples / (area / spacing^2)
    apart: tuple[float, float]  # bounds of the distance to the nearest neighbour / spacing
    off: float  # bound of the distance of the mean from the middle / spacing
    exact: float = 1e-12  # largest distance of samples from the shape [m]
    flat: bool = False
    outline: Callable[[Size], float] = lambda size: (
        0.0
    )  # length of the outline, if samples lie on it [m]


def rectangle_distance(points: Floats, size: Size) -> Floats:
    nearest = np.clip(points, [-size[0] / 2, -size[1] / 2, 0], [size[0] / 2, size[1] / 2, 0])
    return np.linalg.norm(points - nearest, axis=1)


def disc_distance(points: Floats, size: Size) -> Floats:
    beyond = np.maximum(np.hypot(points[:, 0], points[:, 1]) - size[0] / 2, 0.0)
    return np.hypot(beyond, points[:, 2])


def segment_distance(points: Floats, radius: float, length: float) -> Floats:
    """Return the distance to a segment along z around the origin, minus the radius."""
    a, b = np.array([0, 0, -length / 2]), np.array([0, 0, length / 2])
    share = np.clip((points - a) @ (b - a) / max(length**2, 1e-300), 0.0, 1.0)
    return np.linalg.norm(points - (a + share[:, None] * (b - a)), axis=1) - radius


def box_distance(points: Floats, size: Size) -> Floats:
    half = np.array(size) / 2
    outside = np.linalg.norm(points - np.clip(points, -half, half), axis=1)
    depth = np.min(np.concatenate([half - points, half + points], axis=1), axis=1)
    return np.where(outside > 0.0, outside, -depth)


def torus(size: Size) -> tuple[float, float]:
    """Return the major and the minor radius."""
    return size[0] / 2 + size[1] / 2, size[0] / 2


def torus_distance(points: Floats, size: Size) -> Floats:
    major, minor = torus(size)
    angle = np.arctan2(points[:, 1], points[:, 0])
    ring = major * np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
    return np.linalg.norm(points - ring, axis=1) - minor


def torus_sdf(size: Size) -> pc.SDF:
    major, minor = torus(size)
    return pc.SDF(
        lambda p: np.hypot(np.hypot(p[:, 0], p[:, 1]) - major, p[:, 2]) - minor,
        (major + minor, major + minor, minor),
    )


# A unit bracelet with sharp edges, stretched on each axis; not convex, and with triangles of all sizes.
BRACELET = trimesh.creation.annulus(r_min=1.0, r_max=2.0, height=1.0, sections=12)


def bracelet(size: Size) -> trimesh.Trimesh:
    return trimesh.Trimesh(BRACELET.vertices * size, BRACELET.faces, process=False)


def winding(mesh: trimesh.Trimesh, points: Floats) -> Floats:
    """Return the winding number of each point (van Oosterom and Strackee): 1 inside, 0 outside."""
    a, b, c = (mesh.triangles[None, :, i] - points[:, None] for i in range(3))
    la, lb, lc = (np.linalg.norm(v, axis=2) for v in (a, b, c))
    above = np.einsum("ijk,ijk->ij", a, np.cross(b, c))
    dots = [np.einsum("ijk,ijk->ij", u, v) for u, v in ((a, b), (b, c), (c, a))]
    below = la * lb * lc + dots[0] * lc + dots[1] * la + dots[2] * lb
    return np.arctan2(above, below).sum(axis=1) / (2 * math.pi)


def mesh_distance(mesh: trimesh.Trimesh, points: Floats) -> Floats:
    millimetres = trimesh.Trimesh(
        1e3 * mesh.vertices, mesh.faces, process=False
    )  # because of trimesh's tolerances
    distance = trimesh.proximity.closest_point_naive(millimetres, 1e3 * points)[1] / 1e3
    return np.where(winding(mesh, points) > 0.5, -distance, distance)


KINDS = (
    Kind(
        "rectangle",
        lambda s: pc.Rectangle(s[0], s[1]),
        rectangle_distance,
        lambda s: s[0] * s[1],
        number=(1.0, 1.0 + 1e-6),
        apart=(0.5, 1.0 + 1e-6),
        off=1e-9,
        flat=True,
        outline=lambda s: 2 * (s[0] + s[1]),
    ),
    Kind(
        "disc",
        lambda s: pc.Disc(s[0] / 2),
        disc_distance,
        lambda s: math.pi * s[0] ** 2 / 4,
        number=(0.9, 1.0),
        apart=(0.4, 1.0 + 1e-6),
        off=0.2,
        flat=True,
        outline=lambda s: 1.2 * math.pi * s[0],
    ),
    Kind(
        "sphere",
        lambda s: pc.Sphere(s[0] / 2),
        lambda p, s: np.linalg.norm(p, axis=1) - s[0] / 2,
        lambda s: math.pi * s[0] ** 2,
        number=(0.95, 1.05),
        apart=(0.8, 1.1),
        off=0.1,
    ),
    Kind(
        "box",
        pc.Box,
        box_distance,
        lambda s: 2 * (s[0] * s[1] + s[1] * s[2] + s[2] * s[0]),
        number=(9 / 16, 1.0 + 1e-6),
        apart=(math.sqrt(0.5), 4 / 3),  # the nearest may be behind an edge, half a step away
        off=1e-9,
    ),
    Kind(
        "capsule",
        lambda s: pc.Capsule(s[0] / 2, s[1]),
        lambda p, s: segment_distance(p, s[0] / 2, s[1]),
        lambda s: math.pi * s[0] ** 2 + math.pi * s[0] * s[1],
        number=(0.95, 1.05),
        apart=(0.8, 1.1),
        off=0.1,
    ),
    Kind(
        "mesh",
        lambda s: mesh_of(bracelet(s)),
        lambda p, s: mesh_distance(bracelet(s), p),
        lambda s: float(bracelet(s).area),
        number=(0.75, 1.1),
        apart=(0.8, 2.0),
        off=0.5,
    ),
    Kind(
        "sdf",
        torus_sdf,
        torus_distance,
        lambda s: 4 * math.pi**2 * math.prod(torus(s)),
        number=(0.75, 1.1),
        apart=(0.8, 2.0),
        off=0.5,
        exact=1e-8,
    ),
)
each_kind = pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.name)
SOLIDS = tuple(kind for kind in KINDS if kind.name in ("sphere", "box", "capsule", "sdf"))
each_solid = pytest.mark.parametrize("kind", SOLIDS, ids=lambda kind: kind.name)
bounded = settings(max_examples=6)


@st.composite
def sizes(draw: DrawFn, low: float = 3.0, high: float = 8.0) -> tuple[Size, float]:
    """Draw sizes from `low` to `high` spacings, and the spacing [m]."""
    spacing = draw(st.floats(0.003, 0.015))
    x, y, z = (draw(st.floats(low, high)) * spacing for _ in range(3))
    return (x, y, z), spacing


@each_kind
@given(case=sizes())
@bounded
def test_a_cover_lies_on_the_shape_and_faces_outward(kind: Kind, case: tuple[Size, float]) -> None:
    size, spacing = case
    points, normals, _ = kind.make(size).sample_surface(spacing)
    assert points.dtype == np.float64
    assert np.abs(kind.distance(points, size)).max() < kind.exact
    assert np.linalg.norm(normals, axis=1) == pytest.approx(np.ones(len(points)), abs=1e-9)
    if kind.flat:
        assert (normals == [0, 0, 1]).all()
    else:
        step = 1e-4 * spacing
        outside = kind.distance(points + step * normals, size)
        inside = kind.distance(points - step * normals, size)
        for out in (outside, -inside):  # less than a step only near an edge
            assert out.min() > 0.0
            assert out.max() < 1.001 * step
            assert np.median(out) == pytest.approx(step, rel=1e-3)


@each_kind
@given(case=sizes())
@bounded
def test_a_cover_is_even_and_leaves_nothing_bare(kind: Kind, case: tuple[Size, float]) -> None:
    size, spacing = case
    shape = kind.make(size)
    points, _, area = shape.sample_surface(spacing)
    low, high = kind.number
    expected = kind.area(size) / spacing**2
    # shapes with samples on their outline have one more row on each side
    edge = kind.outline(size) / spacing
    assert low * expected - 0.5 <= len(points) <= high * expected + 0.5 + edge + 4 * (edge > 0.0)
    nearest = KDTree(points).query(points, k=2)[0][:, 1] / spacing
    assert kind.apart[0] - 1e-9 <= nearest.min()
    assert nearest.max() <= kind.apart[1]
    assert KDTree(points).query(shape.sample_surface(spacing / 2).points)[0].max() < 1.5 * spacing
    assert np.linalg.norm(points.mean(axis=0)) < kind.off * spacing
    assert area.max() < 4.0 * spacing**2  # not much larger than a cell
    assert area.sum() == pytest.approx(kind.area(size), rel=0.1)
    for again, first in zip(
        kind.make(size).sample_surface(spacing), (points, _, area), strict=True
    ):
        assert np.array_equal(again, first)


# a signed distance has a test of its own


def test_a_signed_distance_smaller_than_the_spacing_is_sampled_on_its_shell() -> None:
    ball = pc.SDF(lambda p: np.linalg.norm(p, axis=1) - 0.001, (0.001, 0.001, 0.001))
    points, normals, area = ball.sample_surface(0.0085)
    assert area.sum() == pytest.approx(4e-6 * math.pi, rel=0.01)
    assert np.linalg.norm(points, axis=1) == pytest.approx(np.full(len(points), 0.001))
    assert np.linalg.norm(normals, axis=1) == pytest.approx(np.ones(len(points)))


def test_a_signed_distance_without_a_shell_in_its_box_has_no_samples() -> None:
    nothing = pc.SDF(lambda p: np.linalg.norm(p, axis=1) + 0.1, (0.02, 0.02, 0.02))
    points, normals, area = nothing.sample_surface(0.0085)
    assert points.shape == normals.shape == (0, 3)
    assert area.shape == (0,)
    assert nothing.area == 0.0
    assert len(sample_interior(nothing, 0.0085).points) == 0


@each_kind
@given(case=sizes(low=0.02))
@bounded
def test_the_samples_stand_for_the_area_of_the_formula_however_small_the_shape_is(
    kind: Kind, case: tuple[Size, float]
) -> None:
    size, spacing = case
    if kind.name == "sdf":  # its area is measured; small ones have their own test
        size = max(size[0], 3 * spacing), max(size[1], 3 * spacing), size[2]
    shape = kind.make(size)
    measured = 0.02 if kind.name == "sdf" else 1e-12
    assert shape.area == pytest.approx(kind.area(size), rel=measured)
    points, _, area = shape.sample_surface(spacing)
    assert np.abs(kind.distance(points, size)).max() < kind.exact
    assert area.sum() == pytest.approx(shape.area, rel=1e-9)
    assert area.min() > 0.0


# ------------------------------------------------------------------- signed distances, interiors


@pytest.mark.parametrize("kind", KINDS[:2], ids=lambda kind: kind.name)
@given(case=sizes(), seed=st.integers(0, 2**31))
@bounded
def test_distances_of_flat_shapes_are_signed_by_side_and_positive_beside_them(
    kind: Kind, case: tuple[Size, float], seed: int
) -> None:
    size, _ = case
    points = np.random.default_rng(seed).uniform(-1.0, 1.0, (200, 3)) * size
    beside = kind.distance(points * (1.0, 1.0, 0.0), size) > 0.0
    assert beside.any()
    sign = np.where(beside, 1.0, np.sign(points[:, 2]))
    expected = sign * kind.distance(points, size)
    assert kind.make(size).distance(points) == pytest.approx(expected, abs=1e-12)


@each_kind
@given(case=sizes(), seed=st.integers(0, 2**31))
@bounded
def test_distance_grows_as_fast_as_one_goes(
    kind: Kind, case: tuple[Size, float], seed: int
) -> None:
    size, _ = case
    shape = kind.make(size)
    points = np.random.default_rng(seed).uniform(-1.2, 1.2, (100, 3)) * size
    slope = np.linalg.norm(gradient(shape, points, 1e-7), axis=1)
    assert np.mean(np.abs(slope - 1.0) < 1e-3) > 0.98  # except where two sides are equally near
    assert shape.distance(np.zeros((0, 3))).shape == (0,)


@each_solid
@given(case=sizes(), seed=st.integers(0, 2**31))
@bounded
def test_signed_distances_are_those_of_independent_formulas(
    kind: Kind, case: tuple[Size, float], seed: int
) -> None:
    size, _ = case
    shape = kind.make(size)
    points = np.random.default_rng(seed).uniform(-1.5, 1.5, (200, 3)) * shape.extent
    expected = kind.distance(points, size)
    assert shape.distance(points) == pytest.approx(expected, abs=1e-12)


@each_solid
@given(case=sizes())
@bounded
def test_a_solid_fits_tightly_in_its_bounding_box(kind: Kind, case: tuple[Size, float]) -> None:
    size, spacing = case
    shape = kind.make(size)
    reach = np.abs(shape.sample_surface(spacing / 2).points).max(axis=0)
    assert (reach <= np.array(shape.extent) + kind.exact).all()
    assert (reach > np.array(shape.extent) - spacing).all()


@each_solid
@given(case=sizes(low=4.0, high=7.0))
@bounded
def test_interior_samples_are_those_of_the_surface_and_a_grid_that_fills_the_solid(
    kind: Kind, case: tuple[Size, float]
) -> None:
    size, spacing = case
    shape = kind.make(size)
    points, normals, area = sample_interior(shape, spacing)
    shell = shape.sample_surface(spacing)
    on = len(shell.points)
    np.testing.assert_array_equal(points[:on], shell.points)
    np.testing.assert_array_equal(normals[:on], shell.normals)
    assert area[:on] == pytest.approx(0.5 * spacing**2)
    assert area[on:] == pytest.approx(spacing**2)
    points, normals = points[on:], normals[on:]
    assert (kind.distance(points, size) < -0.5 * spacing).all()
    for axis, half in enumerate(shape.extent):
        steps = max(1, math.floor(2.0 * half / spacing + 1e-9))
        place = (points[:, axis] + half) / (2.0 * half / steps) - 0.5
        assert place == pytest.approx(np.round(place), abs=1e-6)
    size_of_normals = np.linalg.norm(normals, axis=1)
    middle = size_of_normals < 0.5  # where two sides are equally near
    assert size_of_normals[~middle] == pytest.approx(np.ones((~middle).sum()))
    assert (size_of_normals[middle] == 0.0).all()
    if kind.name != "sdf":
        assert (
            (points * normals).sum(axis=1) >= -1e-12
        ).all()  # normals point away from the middle


@each_solid
@given(case=sizes(low=1.0, high=6.0))
@bounded
def test_no_place_in_a_solid_is_far_from_an_interior_sample(
    kind: Kind, case: tuple[Size, float]
) -> None:
    size, spacing = case
    if kind.name == "sdf":
        size = max(size[0], 3 * spacing), max(size[1], 3 * spacing), size[2]
    shape = kind.make(size)
    places = np.random.default_rng(0).uniform(-1.0, 1.0, (500, 3)) * shape.extent
    places = places[kind.distance(places, size) < 0.0]
    samples = sample_interior(shape, spacing).points
    assert KDTree(samples).query(places)[0].max(initial=0.0) < 1.2 * spacing


def test_too_many_interior_samples_are_refused_before_memory_is() -> None:
    with pytest.raises(pc.ArgumentError, match=r"spacing.*samples.*larger"):
        sample_interior(pc.Box((1.0, 1.0, 1.0)), 1e-4)


# -------------------------------------------------------------------------------- bad sizes


@pytest.mark.parametrize(
    ("make", "argument"),
    [
        (lambda x: pc.Rectangle(x, 0.1), "width"),
        (lambda x: pc.Rectangle(0.1, x), "height"),
        (pc.Disc, "radius"),
        (pc.Sphere, "radius"),
        (lambda x: pc.Box((0.1, x, 0.1)), "size"),
        (lambda x: pc.Capsule(x, 0.1), "radius"),
        (lambda x: pc.Capsule(0.1, x), "length"),
        (lambda x: pc.SDF(lambda p: p[:, 0], (0.1, 0.1, x)), "extent"),
    ],
)
def test_bad_sizes_are_refused_by_the_argument_s_name(
    make: Callable[[Any], Any], argument: str
) -> None:
    for bad, said in ((0.0, "more than 0"), (20.0, "millimetres"), (10**400, "number")):
        with pytest.raises(pc.ArgumentError, match=f"^`{argument}` .*{said}") as caught:
            make(bad)
        assert caught.value.argument == argument


def test_a_box_has_three_sizes() -> None:
    assert pc.Box(np.array([0.1, 0.2, 0.3])) == pc.Box((0.1, 0.2, 0.3))
    for bad in ((0.1, 0.1), 0.1, "abc"):
        with pytest.raises(pc.ArgumentError, match=r"^`size` "):
            pc.Box(bad)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    "function",
    [
        lambda _: np.zeros(7),
        lambda p: np.zeros((len(p), 1)),
        lambda p: np.full(len(p), np.nan),
        lambda _: 0.0,
        lambda p: p[:, 0] + 0j,
        lambda _: "far",
    ],
)
def test_a_signed_distance_that_is_not_one_finite_number_a_point_is_refused(function: Any) -> None:
    solid = pc.SDF(function, (0.02, 0.02, 0.02))
    for ask in (solid.sample_surface, lambda spacing: sample_interior(solid, spacing)):
        with pytest.raises(pc.ArgumentError, match=r"^`function` "):
            ask(0.005)


@each_kind
def test_shapes_cannot_be_changed(kind: Kind) -> None:
    shape = kind.make((0.05, 0.04, 0.03))
    for name in shape.__struct_fields__:
        with pytest.raises(AttributeError):
            setattr(shape, name, 0.01)


def test_a_signed_distance_may_be_computed_in_place() -> None:
    def distance(p: Any) -> Any:
        p *= p
        return np.sqrt(p.sum(axis=1)) - 0.02

    solid = pc.SDF(distance, (0.03, 0.03, 0.03))
    samples = solid.sample_surface(0.005)
    np.testing.assert_allclose(np.linalg.norm(samples.points, axis=1), 0.02, atol=1e-4)
    assert len(samples.points) > 100


def test_the_function_of_an_sdf_is_called_by_one_thread_at_a_time() -> None:
    inside, most = 0, 0
    met = threading.Event()

    def distance(points: Any) -> Any:
        nonlocal inside, most
        inside += 1
        most = max(most, inside)
        met.wait(0.01)  # another thread would come in
        inside -= 1
        return np.linalg.norm(points, axis=1) - 0.01

    ball, points = pc.SDF(distance, (0.01, 0.01, 0.01)), np.zeros((3, 3))
    threads = [threading.Thread(target=ball.distance, args=(points,)) for _ in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert most == 1
