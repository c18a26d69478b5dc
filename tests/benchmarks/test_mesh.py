"""Ratios within one run: `pytest -m benchmark -n 0`.

A hand's 500 points, of which 100 are within 5 mm of a mesh. `extra_info` holds how many times faster than
exact distances for all, how many times as long as libigl's tree alone takes for the 100, and how many
times as long the mesh took to prepare. trimesh's own `signed_distance` needs rtree, which is not installed.
"""

import time
from typing import Any

import numpy as np
import pytest
import trimesh

import pacinian as pc

from .medians import measure_medians


def torus(F: int) -> trimesh.Trimesh:
    """About F triangles, 0.12 m across, with dents."""
    n = round((F / 2) ** 0.5)
    made = trimesh.creation.torus(0.04, 0.02, major_sections=n, minor_sections=n)
    dents = 1.0 + 0.05 * np.sin(100.0 * made.vertices).prod(axis=1, keepdims=True)
    return trimesh.Trimesh(made.vertices * dents, made.faces, process=False)


def hand(mesh: pc.Mesh, far: float) -> Any:
    """Of points about the mesh, 100 within 5 mm and 400 up to `far` [m]."""
    points = np.random.default_rng(0).uniform(-0.1, 0.1, (20_000, 3))
    d = np.asarray(mesh.distance(points))
    return np.concatenate([points[np.abs(d) < 0.005][:100], points[(d > 0.005) & (d < far)][:400]])


@pytest.mark.parametrize("F", [1_000, 10_000, 100_000])
def test_a_hand_about_a_mesh(benchmark: Any, F: int) -> None:
    shape = torus(F)
    mesh = pc.Mesh(vertices=shape.vertices, faces=shape.faces)  # type: ignore[arg-type]
    points = hand(mesh, 0.1)
    benchmark(mesh.distance, points, 0.005)
    culled, exact, tree, one = measure_medians(
        lambda: mesh.distance(points, 0.005),
        lambda: mesh.distance(points),
        lambda: mesh.triangles.distance.compute_unsigned(points[:100]),
        lambda: mesh.distance(points[:1], 0.005),
        repeats=30,
    )
    begin = time.perf_counter()
    again = pc.Mesh(vertices=mesh.vertices, faces=mesh.faces)
    again.distance(points, 0.005)
    benchmark.extra_info |= {
        "times_faster_than_exact": round(exact / culled, 1),
        "over_tree_of_the_near": round(culled / tree, 2),
        "one_point_over_all": round(one / culled, 2),
        "preparing_over_a_call": round((time.perf_counter() - begin) / culled),
    }


@pytest.mark.parametrize("deep", [0.002, np.inf], ids=["2 mm", "exact"])
def test_a_hand_inside_of_a_mesh(benchmark: Any, deep: float) -> None:
    shape = trimesh.creation.icosphere(5, 0.05)
    mesh = pc.Mesh(vertices=shape.vertices, faces=shape.faces)  # type: ignore[arg-type]
    points = np.random.default_rng(0).uniform(-0.028, 0.028, (500, 3))
    benchmark(mesh.distance, points, 0.005, deep)
    rough, exact = measure_medians(
        lambda: mesh.distance(points, 0.005, deep), lambda: mesh.distance(points), repeats=5
    )
    benchmark.extra_info["times_faster_than_exact"] = round(exact / rough, 1)
