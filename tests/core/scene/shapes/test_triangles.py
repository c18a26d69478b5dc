"""Functions on triangle meshes, compared with libigl, SciPy and trimesh."""

from __future__ import annotations

from typing import Any

import igl
import numpy as np
import pytest
import trimesh
from hypothesis import given
from hypothesis import strategies as st
from scipy import ndimage

from pacinian.native import scene as kernels
from pacinian.scene.shapes.mesh_repair import merge_vertices
from pacinian.scene.shapes.triangle_points import find_barycentric, pick_points
from pacinian.scene.shapes.triangle_tree import TriangleTree
from pacinian.scene.shapes.winding import winding_number


def draw_soup(seed: int, count: int) -> tuple[Any, Any]:
    """Draw triangles between few points; some have no area."""
    random = np.random.default_rng(seed)
    vertices = random.normal(size=(max(3, count // 2), 3))
    return vertices, random.integers(0, len(vertices), (count, 3)).astype(np.int64)


@given(st.integers(0, 10_000), st.integers(1, 100))
def test_the_nearest_triangle_is_that_of_libigl(seed: int, count: int) -> None:
    vertices, faces = draw_soup(seed, count)
    points = np.random.default_rng(seed + 1).normal(size=(20, 3)) * 2.0
    squared, face, nearest = TriangleTree(vertices, faces).find_closest(points)
    expected = igl.point_mesh_squared_distance(points, vertices, faces)[0]
    np.testing.assert_allclose(squared, expected, rtol=1e-9, atol=1e-14)
    np.testing.assert_allclose(((points - nearest) ** 2).sum(axis=1), squared, rtol=1e-12)
    for point, f, d in zip(points, face, squared, strict=True):
        own = igl.point_mesh_squared_distance(point[None], vertices, faces[f : f + 1])[0]
        assert np.ravel(own) == pytest.approx(d, rel=1e-9, abs=1e-14)


def test_points_that_are_not_finite_are_infinitely_far() -> None:
    vertices, faces = draw_soup(0, 30)
    points = np.array([[np.nan, 0.0, 0.0], [np.inf, 0.0, 0.0], [0.0, 0.0, 0.0]])
    squared = TriangleTree(vertices, faces).find_closest(points)[0]
    assert np.isinf(squared).tolist() == [True, True, False]


@given(st.integers(0, 10_000), st.tuples(*[st.integers(1, 12)] * 3), st.floats(0.0, 1.0))
def test_cells_are_measured_and_labelled_as_by_scipy(
    seed: int, shape: tuple[int, int, int], share: float
) -> None:
    marked = np.random.default_rng(seed).random(shape) < share
    squared, part = np.empty(shape), np.empty(shape, np.int64)
    kernels.measure_cells(marked, squared)
    if marked.any():
        np.testing.assert_array_equal(np.sqrt(squared), ndimage.distance_transform_edt(~marked))
    else:
        assert (squared == 1e12).all()
    expected, count = ndimage.label(marked)
    assert kernels.label_cells(marked, part) == count
    np.testing.assert_array_equal(part, expected)


@given(st.integers(0, 10_000), st.integers(1, 200))
def test_vertices_are_merged_as_by_trimesh(seed: int, count: int) -> None:
    random = np.random.default_rng(seed)
    vertices = random.integers(0, 3, (max(3, count // 3), 3)) * 0.01
    vertices += random.choice([0.0, 3e-9], vertices.shape)
    faces = random.integers(0, len(vertices), (count, 3)).astype(np.int64)
    mesh = trimesh.Trimesh(vertices, faces, process=False)
    mesh.merge_vertices()
    distinct = (mesh.faces != np.roll(mesh.faces, 1, axis=1)).all(axis=1)
    mesh.update_faces(distinct & mesh.unique_faces())
    mesh.remove_unreferenced_vertices()
    found = merge_vertices(vertices, faces)
    np.testing.assert_array_equal(found[0], mesh.vertices)
    np.testing.assert_array_equal(found[1], np.reshape(mesh.faces, (-1, 3)))


@given(st.integers(0, 10_000), st.integers(1, 60))
def test_bodies_are_what_edges_connect(seed: int, count: int) -> None:
    random = np.random.default_rng(seed)
    edges = random.integers(0, 2 * count, (count, 3)).astype(np.int64)
    body = np.empty(count, np.int64)
    number = kernels.label_bodies(edges, np.empty(2 * count, np.int64), body)
    joined = (edges[:, None, :, None] == edges[None, :, None, :]).any(axis=(2, 3))
    for _ in range(count):
        joined = joined @ joined
    first = joined.argmax(axis=1)
    assert body.tolist() == np.unique(first, return_inverse=True)[1].tolist()
    assert number == len(set(first.tolist()))


def test_points_are_picked_as_by_trimesh() -> None:
    ball = trimesh.creation.icosphere(2, 0.1)
    points, face = pick_points(np.asarray(ball.triangles), np.asarray(ball.area_faces), 500)
    expected, at = trimesh.sample.sample_surface(ball, 500, seed=0)[:2]
    np.testing.assert_array_equal(face, at)
    np.testing.assert_allclose(points, expected, rtol=0.0, atol=1e-16)
    shares = find_barycentric(np.asarray(ball.triangles)[face], points)
    np.testing.assert_allclose(
        shares, trimesh.triangles.points_to_barycentric(ball.triangles[face], points), rtol=1e-12
    )


def test_a_winding_number_counts_the_turns_around_a_point() -> None:
    ball = trimesh.creation.icosphere(2, 0.1)
    points = np.random.default_rng(0).uniform(-0.15, 0.15, (300, 3))
    away = np.linalg.norm(points, axis=1)
    points = points[(away < 0.09) | (away > 0.1)]
    inside = np.linalg.norm(points, axis=1) < 0.1
    turns = winding_number(np.asarray(ball.triangles), points)
    assert turns == pytest.approx(inside.astype(float), abs=1e-9)
