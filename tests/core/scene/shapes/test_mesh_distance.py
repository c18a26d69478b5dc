from __future__ import annotations

import functools
import math
from typing import TYPE_CHECKING, Any

import igl
import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st

from ..tools import mesh_of

if TYPE_CHECKING:
    from pacinian.types import Floats

bounded = settings(max_examples=12)
seeds = st.integers(0, 2**31)


def bumpy(level: int) -> trimesh.Trimesh:
    ball = trimesh.creation.icosphere(level, 0.05)
    shape = 1.0 + 0.2 * np.sin(80.0 * ball.vertices[:, :1]) * np.cos(60.0 * ball.vertices[:, 1:2])
    return trimesh.Trimesh(ball.vertices * shape, ball.faces, process=False)


def star() -> trimesh.Trimesh:
    """Return a ball with spikes and dents: sharp edges, corners and needles."""
    ball = trimesh.creation.icosphere(1, 0.02)
    peaks = ball.triangles_center * np.where(np.arange(len(ball.faces)) % 2, 2.5, 0.6)[:, None]
    tip = len(ball.vertices) + np.arange(len(ball.faces))
    faces = [np.stack([ball.faces[:, k], ball.faces[:, (k + 1) % 3], tip], 1) for k in range(3)]
    return trimesh.Trimesh(
        np.concatenate([ball.vertices, peaks]), np.concatenate(faces), process=False
    )


def hemisphere() -> trimesh.Trimesh:
    """Return a hemisphere of radius 0.04 m, z > 0, facing outwards."""
    ball = trimesh.creation.icosphere(4, 0.04)
    return trimesh.Trimesh(
        ball.vertices, ball.faces[ball.triangles_center[:, 2] > 0.0], process=False
    )


def sheet(n: int = 6) -> trimesh.Trimesh:
    """Return a sheet of 0.06 by 0.04 m around the origin, facing +z."""
    x, y = np.meshgrid(np.linspace(-0.03, 0.03, n), np.linspace(-0.02, 0.02, n))
    vertices = np.stack([x, y, 0 * x], axis=-1).reshape(-1, 3)
    i = np.arange(n * n).reshape(n, n)
    a, b, c, d = (corner.ravel() for corner in (i[:-1, :-1], i[:-1, 1:], i[1:, :-1], i[1:, 1:]))
    faces = np.concatenate([np.stack([a, b, d], 1), np.stack([a, d, c], 1)])
    return trimesh.Trimesh(vertices, faces, process=False)


CLOSED = {
    "tetrahedron": trimesh.Trimesh(
        0.04 * np.array([(1.0, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1)]),
        [[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]],
        process=False,
    ),
    "box": trimesh.creation.box((0.06, 0.04, 0.02)),
    "plate": trimesh.creation.box((0.2, 0.1, 0.0005)),
    "bracelet": trimesh.creation.annulus(r_min=0.02, r_max=0.04, height=0.02, sections=12),
    "torus": trimesh.creation.torus(0.04, 0.01, major_sections=24, minor_sections=12),
    "star": star(),
    "bumpy": bumpy(3),
}
OPEN = {"hemisphere": hemisphere(), "sheet": sheet()}
each = pytest.mark.parametrize(
    "mesh", [*CLOSED.values(), *OPEN.values()], ids=[*CLOSED.keys(), *OPEN.keys()]
)


made = functools.cache(mesh_of)  # cached, with the structures for distances


def about(mesh: trimesh.Trimesh, seed: int, number: int) -> Floats:
    """Return points around a mesh, half of them near edges and corners."""
    rng = np.random.default_rng(seed)
    anywhere = rng.uniform(1.5 * mesh.bounds[0], 1.5 * mesh.bounds[1] + 1e-3, (number, 3))
    edges = mesh.vertices[mesh.edges_unique[rng.integers(len(mesh.edges_unique), size=number)]]
    share = rng.choice([0.0, 0.3, 0.5], (number, 1))
    on = share * edges[:, 0] + (1.0 - share) * edges[:, 1]
    return np.concatenate(
        [anywhere, on + rng.normal(0.0, 1.0, on.shape) * 10.0 ** -rng.uniform(2, 5)]
    )


def to_segments(p: Floats, a: Floats, b: Floats) -> Floats:
    along = b - a
    share = ((p - a) * along).sum(-1) / np.maximum((along * along).sum(-1), 1e-300)
    return np.linalg.norm(p - a - np.clip(share, 0.0, 1.0)[..., None] * along, axis=-1)


def brute(mesh: trimesh.Trimesh, points: Floats) -> Floats:
    """Return the distance to the nearest triangle by brute force: to its plane if inside, otherwise to its sides."""
    a, b, c = (mesh.vertices[mesh.faces[:, k]] for k in range(3))
    n = np.cross(b - a, c - a)
    n /= np.linalg.norm(n, axis=1, keepdims=True)
    found = np.empty(len(points))
    for i, p in enumerate(points):
        inside = np.ones(len(a), dtype=bool)
        for u, v in ((a, b), (b, c), (c, a)):
            inside &= (np.cross(v - u, p - u) * n).sum(axis=1) >= 0.0
        plane = np.abs(((p - a) * n).sum(axis=1))
        sides = np.min([to_segments(p, u, v) for u, v in ((a, b), (b, c), (c, a))], axis=0)
        found[i] = np.where(inside, plane, sides).min()
    return found


def around(mesh: trimesh.Trimesh, points: Floats) -> Floats:
    """Return the winding number of each point, 1 inside and 0 outside, by solid angles."""
    faces = np.asarray(mesh.faces, dtype=np.int64)
    return np.asarray(igl.winding_number(np.asarray(mesh.vertices), faces, points))


@each
@given(seed=seeds)
@bounded
def test_distances_are_those_to_the_nearest_triangle_and_negative_where_it_goes_round(
    mesh: trimesh.Trimesh, seed: int
) -> None:
    points, shape = about(mesh, seed, 100), made(mesh)
    d = shape.distance(points)
    assert d.shape == (200,)
    assert np.abs(d[::4]) == pytest.approx(brute(mesh, points[::4]), abs=1e-12)
    if shape.closed:
        clear = np.abs(d) > 1e-12
        assert (d < 0.0)[clear].tolist() == (around(mesh, points) > 0.5)[clear].tolist()


@each
def test_points_on_the_surface_are_at_no_distance(mesh: trimesh.Trimesh) -> None:
    shape = made(mesh)
    for points in (
        mesh.triangles.reshape(-1, 3),
        mesh.triangles_center,
        shape.sample_surface(0.01).points,
    ):
        assert np.abs(shape.distance(np.asarray(points))).max() < 1e-12


@each
def test_points_that_are_not_finite_are_infinitely_far(mesh: trimesh.Trimesh) -> None:
    points = np.array(
        [(0.0, 0.0, math.nan), (math.inf, 0.0, 0.0), (0.5, 0.0, 0.0), (-math.inf,) * 3]
    )
    for beyond in (math.inf, 0.005):
        d = made(mesh).distance(points, beyond)
        assert np.isinf(d).tolist() == [True, True, False, True]
        assert (d > 0.0).all()


@pytest.mark.parametrize("beyond", [math.inf, 0.005])
def test_there_may_be_no_points_and_they_may_be_of_any_layout(beyond: float) -> None:
    for mesh in (CLOSED["star"], OPEN["sheet"]):
        shape, points = made(mesh), about(mesh, 0, 20)
        assert shape.distance(np.empty((0, 3)), beyond).shape == (0,)
        d = shape.distance(points, beyond)
        frozen = points.copy()
        frozen.flags.writeable = False
        for other in (frozen, np.asfortranarray(points), points[::-1][::-1]):
            assert np.array_equal(shape.distance(other, beyond), d)


# ------------------------------------------------------------------------- open surfaces


@given(seed=seeds)
@bounded
def test_a_sheet_has_a_front_a_back_and_a_beside(seed: int) -> None:
    points = np.random.default_rng(seed).uniform(-0.05, 0.05, (300, 3))
    beside = np.hypot(*np.maximum(np.abs(points[:, :2]) - (0.03, 0.02), 0.0).T)
    size = np.hypot(beside, points[:, 2])
    expected = np.where((points[:, 2] < 0.0) & (beside == 0.0), -size, size)
    assert made(sheet()).distance(points) == pytest.approx(expected, abs=1e-12)


@given(seed=seeds)
@bounded
def test_a_hemisphere_is_negative_within_and_positive_without_and_beside(seed: int) -> None:
    rng = np.random.default_rng(seed)
    u = rng.normal(size=(300, 3))
    points = u / np.linalg.norm(u, axis=1, keepdims=True) * rng.uniform(0.0, 0.08, (300, 1))
    d = made(hemisphere()).distance(points)
    up = points[:, 2] > 0.002  # because the rim is not quite flat
    r = np.linalg.norm(points, axis=1)
    assert d[up] == pytest.approx((r - 0.04)[up], abs=2e-4)
    assert (d[points[:, 2] < -0.002] > 0.0).all()


def test_an_open_surface_faces_where_it_is_wound() -> None:
    surface = hemisphere()
    back = trimesh.Trimesh(surface.vertices, surface.faces[:, ::-1], process=False)
    points = np.array([(0.0, 0.0, 0.035), (0.0, 0.0, 0.045)])
    assert np.sign(made(surface).distance(points)).tolist() == [-1, 1]
    assert np.sign(made(back).distance(points)).tolist() == [1, -1]


def test_a_surface_of_which_each_side_is_given_faces_as_the_first() -> None:
    one = sheet()
    both = np.concatenate([one.faces, one.faces[:, ::-1]])
    points = np.array([(0.001, 0.002, 0.01), (0.001, 0.002, -0.01)])
    d = made(trimesh.Trimesh(one.vertices, both, process=False)).distance(points)
    assert d == pytest.approx([0.01, -0.01])


# ------------------------------------------------------------------------- thin triangles


@pytest.mark.parametrize(("off", "height"), [(0.0, 0.02), (1e-10, 0.1), (-3e-9, 0.02)])
def test_a_triangle_without_area_between_an_edge_and_its_halves_has_no_say(
    off: float, height: float
) -> None:
    """A wedge has a side whose edge is divided in two, and a sliver that closes the gap."""
    a, b, c, d = (0.0, 0.0, height), (0.06, 0.0, height), (0.0, 0.01, 0.0), (0.0, -0.01, 0.0)
    e, f = (0.06, 0.01, 0.0), (0.06, -0.01, 0.0)
    middle = (0.03, 0.0, height + off)
    faces = [
        [0, 2, 3], [1, 5, 4],  # the ends
        [2, 4, 3], [3, 4, 5],  # below
        [0, 1, 2], [1, 4, 2],  # one side, with the whole edge
        [0, 3, 6], [6, 3, 5], [6, 5, 1],  # the other, with its halves
        [0, 6, 1],
    ]  # fmt: skip
    wedge = trimesh.Trimesh([a, b, c, d, e, f, middle], faces, process=False)
    shape = made(wedge)
    assert shape.closed
    rng = np.random.default_rng(0)
    edge = np.array([0.0, 0.0, height]) + rng.uniform(0.0, 0.06, (300, 1)) * (1.0, 0.0, 0.0)
    points = edge + rng.normal(0.0, 0.003, (300, 3)) * (0.0, 1.0, 1.0)
    plain = trimesh.Trimesh(wedge.vertices[:6], [*faces[:6], [0, 3, 1], [1, 3, 5]], process=False)
    expected = made(plain).distance(points)
    assert (np.sign(expected) == np.where(around(plain, points) > 0.5, -1, 1)).all()
    assert shape.distance(points) == pytest.approx(expected, abs=1e-8)


def test_a_triangle_without_area_on_the_rim_leaves_it_a_rim() -> None:
    corners = [(0.0, 0.0, 0.0), (0.02, 0.0, 0.0), (0.04, 0.0, 0.0), (0.02, 0.03, 0.0)]
    shape = made(trimesh.Trimesh(corners, [[0, 2, 3], [0, 1, 2]], process=False))
    points = np.array([(0.01, -0.01, -0.001), (0.01, -0.01, 0.001), (0.02, 0.01, -0.001)])
    assert np.sign(shape.distance(points)).tolist() == [1, 1, -1]


def test_needles_keep_their_side() -> None:
    disc = trimesh.creation.cylinder(0.03, 0.002, sections=2000)
    points = about(disc, 0, 300)
    d = made(disc).distance(points)
    r, z = np.hypot(points[:, 0], points[:, 1]) - 0.03, np.abs(points[:, 2]) - 0.001
    expected = np.hypot(np.maximum(r, 0.0), np.maximum(z, 0.0)) + np.minimum(np.maximum(r, z), 0.0)
    assert d == pytest.approx(expected, abs=1e-7)


# ------------------------------------------------------------------------- what is far away

limits = st.one_of(st.just(0.0), st.floats(0.0, 0.03), st.just(math.inf))


@each
@given(seed=seeds, beyond=limits, deep=limits)
@bounded
def test_what_is_farther_than_asked_is_only_given_as_less_far(
    mesh: trimesh.Trimesh, seed: int, beyond: float, deep: float
) -> None:
    shape, points = made(mesh), about(mesh, seed, 200)
    points[:20] *= 10.0
    d, rough = shape.distance(points), shape.distance(points, beyond, deep)
    near = (d <= beyond) & (d >= -deep)
    assert np.array_equal(rough[near], d[near])
    assert (np.abs(rough) <= np.abs(d) + 1e-12).all()
    if shape.closed:
        assert (rough[d > beyond] > beyond).all()
        assert (rough[d < -deep] < -deep).all()
        return
    assert ((rough > beyond) | (rough < -deep))[~near].all()
    # as used by the contact with a sheet of some thickness
    felt, told = (np.maximum(x, -x - 0.5 * deep) for x in (d, rough))
    inside = felt <= 0.0
    assert np.array_equal(told[inside], felt[inside])
    assert (told[~inside] > 0.0).all()


def test_deep_behind_an_open_surface_nothing_is_rough_unless_asked() -> None:
    points = np.array([(0.0, 0.0, -0.04), (0.0, 0.0, 0.04)])
    assert made(sheet()).distance(points, 0.001)[0] == pytest.approx(-0.04)
    assert (made(sheet()).distance(points, 0.001, 0.002) > 0.002).all()


def test_few_more_points_are_asked_for_than_are_near(monkeypatch: pytest.MonkeyPatch) -> None:
    """There are as many points as on a hand, and a fifth of them touch."""
    shape, rng = made(bumpy(4)), np.random.default_rng(0)
    points = rng.uniform(-0.12, 0.12, (20_000, 3))
    d = shape.distance(points)
    points = np.concatenate([points[np.abs(d) < 0.005][:100], points[d > 0.005][:400]])
    asked: list[int] = []
    tree = shape.triangles.distance.tree

    class Counting:
        def find_closest(self, P: Any) -> Any:
            asked.append(len(P))
            return tree.find_closest(P)

    shape.distance(points, 0.005)
    monkeypatch.setattr(shape.triangles.distance, "tree", Counting())
    shape.distance(points, 0.005)
    assert asked[0] < 150


def test_a_large_mesh_has_no_more_cells_than_memory_holds() -> None:
    for size in ((9.0, 9.0, 9.0), (9.0, 9.0, 1e-4), (9.0, 1e-3, 1e-3), (1e-4, 1e-4, 1e-4)):
        shape = made(trimesh.creation.box(size))
        points = np.random.default_rng(0).uniform(-10.0, 10.0, (200, 3))
        assert (shape.distance(points, 0.01) > 0.0).all() == (shape.distance(points) > 0.0).all()
        assert shape.triangles.distance.bounds.gap.size < 1_000_000
