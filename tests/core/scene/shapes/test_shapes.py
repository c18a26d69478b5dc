from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial import KDTree

import pacinian as pc
from pacinian.scene.shapes.solids import gradient, interior

if TYPE_CHECKING:
    from collections.abc import Callable

    from hypothesis.strategies import DrawFn

    from pacinian.types import Floats

Size = tuple[float, float, float]  # [m]


class Kind(NamedTuple):
    """A kind of shape, made of three sizes, and what is known of it without asking it."""

    name: str
    make: Callable[[Size], Any]
    # signed distance of points [m], negative inside; of a flat shape, unsigned
    distance: Callable[[Floats, Size], Floats]
    area: Callable[[Size], float]
    number: tuple[float, float]  # bounds of samples / (area / spacing^2)
    apart: tuple[float, float]  # bounds of the distance to the nearest neighbour / spacing
    off: float  # bound of the mean's distance from the middle / spacing
    exact: float = 1e-12  # how far samples may lie from the shape [m]
    flat: bool = False


def rectangle_distance(points: Floats, size: Size) -> Floats:
    nearest = np.clip(points, [-size[0] / 2, -size[1] / 2, 0], [size[0] / 2, size[1] / 2, 0])
    return np.linalg.norm(points - nearest, axis=1)


def disc_distance(points: Floats, size: Size) -> Floats:
    beyond = np.maximum(np.hypot(points[:, 0], points[:, 1]) - size[0] / 2, 0.0)
    return np.hypot(beyond, points[:, 2])


def segment_distance(points: Floats, radius: float, length: float) -> Floats:
    """Distance to a segment along z about the origin, less the radius."""
    a, b = np.array([0, 0, -length / 2]), np.array([0, 0, length / 2])
    share = np.clip((points - a) @ (b - a) / max(length**2, 1e-300), 0.0, 1.0)
    return np.linalg.norm(points - (a + share[:, None] * (b - a)), axis=1) - radius


def box_distance(points: Floats, size: Size) -> Floats:
    half = np.array(size) / 2
    outside = np.linalg.norm(points - np.clip(points, -half, half), axis=1)
    depth = np.min(np.concatenate([half - points, half + points], axis=1), axis=1)
    return np.where(outside > 0.0, outside, -depth)


def torus(size: Size) -> tuple[float, float]:
    """Major and minor radius."""
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


def bracelet_mesh(size: Size) -> pc.Mesh:
    made = bracelet(size)
    return pc.Mesh(
        vertices=tuple(map(tuple, made.vertices.tolist())),
        faces=tuple(map(tuple, made.faces.tolist())),
    )


def winding(mesh: trimesh.Trimesh, points: Floats) -> Floats:
    """How often the mesh goes round each point (van Oosterom and Strackee): 1 inside, 0 outside."""
    a, b, c = (mesh.triangles[None, :, i] - points[:, None] for i in range(3))
    la, lb, lc = (np.linalg.norm(v, axis=2) for v in (a, b, c))
    above = np.einsum("ijk,ijk->ij", a, np.cross(b, c))
    dots = [np.einsum("ijk,ijk->ij", u, v) for u, v in ((a, b), (b, c), (c, a))]
    below = la * lb * lc + dots[0] * lc + dots[1] * la + dots[2] * lb
    return np.arctan2(above, below).sum(axis=1) / (2 * math.pi)


def mesh_distance(mesh: trimesh.Trimesh, points: Floats) -> Floats:
    millimetres = trimesh.Trimesh(1e3 * mesh.vertices, mesh.faces, process=False)  # its tolerances
    distance = trimesh.proximity.closest_point_naive(millimetres, 1e3 * points)[1] / 1e3
    return np.where(winding(mesh, points) > 0.5, -distance, distance)


KINDS = (
    Kind(
        "rectangle",
        lambda s: pc.Rectangle(s[0], s[1]),
        rectangle_distance,
        lambda s: s[0] * s[1],
        number=(9 / 16, 1.0 + 1e-6),  # a grid leaves out less than one row of at least four
        apart=(1.0 - 1e-6, 4 / 3),
        off=1e-9,
        flat=True,
    ),
    Kind(
        "disc",
        lambda s: pc.Disc(s[0] / 2),
        disc_distance,
        lambda s: math.pi * s[0] ** 2 / 4,
        number=(0.9, 1.1),
        apart=(0.8, 1.15),
        off=0.15,
        flat=True,
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
        apart=(math.sqrt(0.5), 4 / 3),  # the nearest may be round an edge, half a step from it
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
        bracelet_mesh,
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
    """Sizes from `low` to `high` spacings, and that spacing [m]."""
    spacing = draw(st.floats(0.003, 0.015))
    x, y, z = (draw(st.floats(low, high)) * spacing for _ in range(3))
    return (x, y, z), spacing


@each_kind
@given(case=sizes())
@bounded
def test_samples_lie_on_the_shape(kind: Kind, case: tuple[Size, float]) -> None:
    size, spacing = case
    points = kind.make(size).cover(spacing).points
    assert points.dtype == np.float64
    assert np.abs(kind.distance(points, size)).max() < kind.exact


@each_kind
@given(case=sizes())
@bounded
def test_normals_are_unit_and_point_outward(kind: Kind, case: tuple[Size, float]) -> None:
    size, spacing = case
    points, normals, _ = kind.make(size).cover(spacing)
    assert normals.shape == points.shape
    assert np.linalg.norm(normals, axis=1) == pytest.approx(np.ones(len(points)), abs=1e-9)
    if kind.flat:
        assert (normals == [0, 0, 1]).all()
    else:
        step = 1e-4 * spacing
        outside = kind.distance(points + step * normals, size)
        inside = kind.distance(points - step * normals, size)
        for out in (outside, -inside):  # less than a step only where an edge is nearer still
            assert out.min() > 0.0
            assert out.max() < 1.001 * step
            assert np.median(out) == pytest.approx(step, rel=1e-3)


@each_kind
@given(case=sizes())
@bounded
def test_there_is_about_one_sample_per_spacing_squared(
    kind: Kind, case: tuple[Size, float]
) -> None:
    size, spacing = case
    expected = kind.area(size) / spacing**2
    low, high = kind.number
    # half a sample for rounding
    assert low * expected - 0.5 <= len(kind.make(size).cover(spacing).points)
    assert len(kind.make(size).cover(spacing).points) <= high * expected + 0.5


@each_kind
@given(case=sizes())
@bounded
def test_neighbours_are_about_a_spacing_apart(kind: Kind, case: tuple[Size, float]) -> None:
    size, spacing = case
    points = kind.make(size).cover(spacing).points
    nearest = KDTree(points).query(points, k=2)[0][:, 1] / spacing
    low, high = kind.apart
    assert low - 1e-9 <= nearest.min()
    assert nearest.max() <= high


@each_kind
@given(case=sizes())
@bounded
def test_no_part_of_a_shape_is_left_bare(kind: Kind, case: tuple[Size, float]) -> None:
    size, spacing = case
    shape = kind.make(size)
    coarse, fine = shape.cover(spacing).points, shape.cover(spacing / 2).points
    assert KDTree(coarse).query(fine)[0].max() < 1.5 * spacing


@each_kind
@given(case=sizes())
@bounded
def test_covering_twice_gives_the_same(kind: Kind, case: tuple[Size, float]) -> None:
    size, spacing = case
    first, second = kind.make(size).cover(spacing), kind.make(size).cover(spacing)
    assert np.array_equal(first.points, second.points)
    assert np.array_equal(first.normals, second.normals)
    assert np.array_equal(first.area, second.area)


@each_kind
@given(case=sizes())
@bounded
def test_the_mean_of_the_samples_is_the_centroid(kind: Kind, case: tuple[Size, float]) -> None:
    size, spacing = case
    mean = kind.make(size).cover(spacing).points.mean(axis=0)
    assert np.linalg.norm(mean) < kind.off * spacing


# a signed distance has a test of its own
@pytest.mark.parametrize("kind", KINDS[:-1], ids=lambda kind: kind.name)
@given(case=sizes(low=0.02, high=1.0))
@bounded
def test_a_shape_smaller_than_the_spacing_has_at_least_one_sample(
    kind: Kind, case: tuple[Size, float]
) -> None:
    size, spacing = case
    points = kind.make(size).cover(spacing).points
    assert len(points) >= 1
    assert np.abs(kind.distance(points, size)).max() < kind.exact


def test_a_signed_distance_smaller_than_the_spacing_is_sampled_on_its_shell() -> None:
    ball = pc.SDF(lambda p: np.linalg.norm(p, axis=1) - 0.001, (0.001, 0.001, 0.001))
    points, normals, area = ball.cover(0.0085)
    assert area.sum() == pytest.approx(4e-6 * math.pi, rel=0.01)
    assert np.linalg.norm(points, axis=1) == pytest.approx(np.full(len(points), 0.001))
    assert np.linalg.norm(normals, axis=1) == pytest.approx(np.ones(len(points)))


def test_a_signed_distance_without_a_shell_in_its_box_has_no_samples() -> None:
    nothing = pc.SDF(lambda p: np.linalg.norm(p, axis=1) + 0.1, (0.02, 0.02, 0.02))
    points, normals, area = nothing.cover(0.0085)
    assert points.shape == normals.shape == (0, 3)
    assert area.shape == (0,)
    assert nothing.area == 0.0
    assert len(interior(nothing, 0.0085).points) == 0


# ----------------------------------------------------------------------------------- areas


@each_kind
@given(case=sizes())
@bounded
def test_the_area_is_that_of_the_formula(kind: Kind, case: tuple[Size, float]) -> None:
    measured = 0.02 if kind.name == "sdf" else 1e-12
    assert kind.make(case[0]).area == pytest.approx(kind.area(case[0]), rel=measured)


@each_kind
@given(case=sizes(low=0.1))
@bounded
def test_the_samples_stand_for_the_whole_area(kind: Kind, case: tuple[Size, float]) -> None:
    size, spacing = case
    shape = kind.make(size)
    area = shape.cover(spacing).area
    assert area.sum() == pytest.approx(shape.area, rel=1e-9)
    assert area.min() > 0.0


@each_kind
@given(case=sizes())
@bounded
def test_no_sample_stands_for_much_more_than_its_cell(kind: Kind, case: tuple[Size, float]) -> None:
    size, spacing = case
    assert kind.make(size).cover(spacing).area.max() < 2.6 * spacing**2


@pytest.mark.parametrize(
    ("shape", "mesh", "share"),
    [
        (pc.Rectangle(0.06, 0.04), trimesh.creation.box((0.06, 0.04, 0.0)), 0.5),
        (pc.Disc(0.03), trimesh.creation.cylinder(0.03, 1e-9, sections=720), 0.5),
        (pc.Sphere(0.03), trimesh.creation.icosphere(5, 0.03), 1.0),
        (pc.Box((0.06, 0.04, 0.02)), trimesh.creation.box((0.06, 0.04, 0.02)), 1.0),
        (pc.Capsule(0.01, 0.05), trimesh.creation.capsule(0.05, 0.01, count=[64, 64]), 1.0),
    ],
    ids=lambda value: type(value).__name__,
)
def test_the_area_is_that_of_a_fine_mesh(shape: Any, mesh: trimesh.Trimesh, share: float) -> None:
    assert shape.area == pytest.approx(share * mesh.area, rel=1e-3)


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
    assert np.mean(np.abs(slope - 1.0) < 1e-3) > 0.98  # but where two sides are as near
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


@pytest.mark.parametrize(
    ("shape", "mesh"),
    [
        (pc.Sphere(0.03), trimesh.creation.icosphere(4, 0.03)),
        (pc.Box((0.06, 0.04, 0.02)), trimesh.creation.box((0.06, 0.04, 0.02))),
        (pc.Capsule(0.01, 0.05), trimesh.creation.capsule(0.05, 0.01, count=[48, 48])),
    ],
    ids=lambda value: type(value).__name__,
)
def test_signed_distances_are_those_to_a_fine_mesh(shape: Any, mesh: trimesh.Trimesh) -> None:
    points = np.random.default_rng(1).uniform(-1.3, 1.3, (60, 3)) * shape.extent
    assert shape.distance(points) == pytest.approx(mesh_distance(mesh, points), abs=1.5e-4)


@each_solid
@given(case=sizes())
@bounded
def test_a_solid_fits_tightly_in_its_bounding_box(kind: Kind, case: tuple[Size, float]) -> None:
    size, spacing = case
    shape = kind.make(size)
    reach = np.abs(shape.cover(spacing / 2).points).max(axis=0)
    assert (reach <= np.array(shape.extent) + kind.exact).all()
    assert (reach > np.array(shape.extent) - spacing).all()


@each_solid
@given(case=sizes())
@bounded
def test_interior_samples_are_inside_on_a_grid(kind: Kind, case: tuple[Size, float]) -> None:
    size, spacing = case
    shape = kind.make(size)
    points, normals, area = interior(shape, spacing)
    assert len(points) > 0
    assert area == pytest.approx(np.full(len(points), spacing**2))
    assert (kind.distance(points, size) < 0.0).all()
    for axis, half in enumerate(shape.extent):
        steps = max(1, math.floor(2.0 * half / spacing + 1e-9))
        place = (points[:, axis] + half) / (2.0 * half / steps) - 0.5
        assert place == pytest.approx(np.round(place), abs=1e-6)
        assert spacing * (1.0 - 1e-6) <= 2.0 * half / steps
    size_of_normals = np.linalg.norm(normals, axis=1)
    middle = size_of_normals < 0.5  # where no side is nearer than another
    assert size_of_normals[~middle] == pytest.approx(np.ones((~middle).sum()))
    assert (size_of_normals[middle] == 0.0).all()


@pytest.mark.parametrize("kind", SOLIDS[:3], ids=lambda kind: kind.name)
@given(case=sizes())
@bounded
def test_interior_normals_point_away_from_the_middle(kind: Kind, case: tuple[Size, float]) -> None:
    size, spacing = case
    points, normals, _ = interior(kind.make(size), spacing)
    assert ((points * normals).sum(axis=1) >= -1e-12).all()


@each_solid
@given(case=sizes(low=4.0, high=7.0))
@bounded
def test_interior_samples_number_about_the_volume_over_the_cell(
    kind: Kind, case: tuple[Size, float]
) -> None:
    size, spacing = case
    shape = kind.make(size)
    cell = math.prod(2 * h / max(1, math.floor(2 * h / spacing + 1e-9)) for h in shape.extent)
    major, minor = torus(size)
    volume = {
        "sphere": math.pi * size[0] ** 3 / 6,
        "box": math.prod(size),
        "capsule": math.pi * size[0] ** 3 / 6 + math.pi * size[0] ** 2 / 4 * size[1],
        "sdf": 2 * math.pi**2 * major * minor**2,
    }[kind.name]
    assert len(interior(shape, spacing).points) == pytest.approx(volume / cell, rel=0.35)


def test_too_many_interior_samples_are_refused_before_memory_is() -> None:
    with pytest.raises(pc.ArgumentError, match=r"spacing.*samples.*larger"):
        interior(pc.Box((1.0, 1.0, 1.0)), 1e-4)


# -------------------------------------------------------------------------------- bad sizes


@pytest.mark.parametrize("bad", [0.0, -0.01, math.nan, math.inf, 20.0, "wide", None])
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
        (lambda x: pc.Mesh(file="any.obj", scale=x), "scale"),
        (lambda x: pc.SDF(lambda p: p[:, 0], (0.1, 0.1, x)), "extent"),
    ],
)
def test_bad_sizes_are_refused_by_the_argument_s_name(
    make: Callable[[Any], Any], argument: str, bad: Any
) -> None:
    with pytest.raises(pc.ArgumentError, match=f"^`{argument}` ") as caught:
        make(bad)
    assert caught.value.argument == argument


def test_sizes_in_millimetres_are_recognised() -> None:
    with pytest.raises(pc.ArgumentError, match=r"metres.*millimetres"):
        pc.Sphere(30.0)


@pytest.mark.parametrize("bad", [(0.1, 0.1), (0.1,) * 4, 0.1, "abc"])
def test_a_box_of_other_than_three_sizes_is_refused(bad: Any) -> None:
    with pytest.raises(pc.ArgumentError, match=r"^`size` "):
        pc.Box(bad)


def test_a_size_beyond_floats_is_refused() -> None:
    with pytest.raises(pc.ArgumentError, match=r"^`radius` "):
        pc.Sphere(10**400)


def test_a_size_given_as_text_is_refused_or_made_a_number() -> None:
    try:
        area = pc.Sphere("0.1").area  # type: ignore[arg-type]
    except pc.ArgumentError:
        return
    assert area == pytest.approx(0.04 * math.pi)


@pytest.mark.parametrize(
    "function",
    [
        lambda _: np.zeros(7),
        lambda p: np.zeros((len(p), 1)),
        lambda p: np.full(len(p), np.nan),
        lambda p: np.full(len(p), np.inf),
        lambda _: 0.0,
    ],
)
def test_a_signed_distance_that_is_not_one_finite_number_a_point_is_refused(function: Any) -> None:
    solid = pc.SDF(function, (0.02, 0.02, 0.02))
    for ask in (solid.cover, lambda spacing: interior(solid, spacing)):
        with pytest.raises(pc.ArgumentError, match=r"^`function` "):
            ask(0.005)


@each_kind
def test_shapes_cannot_be_changed(kind: Kind) -> None:
    shape = kind.make((0.05, 0.04, 0.03))
    for name in shape.__struct_fields__:
        with pytest.raises(AttributeError):
            setattr(shape, name, 0.01)


def test_boxes_may_be_given_by_an_array() -> None:
    assert pc.Box(np.array([0.1, 0.2, 0.3])) == pc.Box((0.1, 0.2, 0.3))
