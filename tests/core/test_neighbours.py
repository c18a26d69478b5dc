"""Nearest points and thinning, compared with SciPy's k-d tree."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial import KDTree

from pacinian.neighbours import find_nearest
from pacinian.scene.shapes.poisson_disk import thin_out


def draw(seed: int, count: int, side: int) -> np.ndarray:
    """Draw points on a small lattice, so that many coincide and many distances are equal. side 0: no lattice."""
    random = np.random.default_rng(seed)
    if not side:
        return random.normal(size=(count, 3))
    return random.integers(0, side, (count, 3)).astype(np.float64)


@given(st.integers(0, 10_000), st.integers(1, 300), st.integers(0, 50), st.sampled_from([0, 2, 5]))
def test_the_nearest_point_is_found(seed: int, count: int, asked: int, side: int) -> None:
    points, queries = draw(seed, count, side), draw(seed + 1, asked, side)
    away, which = find_nearest(points, queries)
    every = np.linalg.norm(points[None] - queries[:, None], axis=2)
    np.testing.assert_allclose(away, every.min(axis=1, initial=np.inf), rtol=1e-12)
    np.testing.assert_array_equal(which, every.argmin(axis=1))  # the first of equal ones


@given(
    st.integers(0, 10_000),
    st.integers(0, 300),
    st.sampled_from([0, 2, 5]),
    st.sampled_from([0.0, 0.3, 1.2]),
    st.integers(0, 5),
)
def test_points_are_thinned_out_as_with_scipy(
    seed: int, count: int, side: int, radius: float, first: int
) -> None:
    points, first = draw(seed, count, side), min(first, count)
    left, kept = np.ones(count, np.bool_), []
    others = first + np.random.default_rng(0).permutation(count - first)
    for i in [*range(first), *others.tolist()]:
        if left[i]:
            kept.append(i)
            left[KDTree(points).query_ball_point(points[i], radius)] = False
    assert thin_out(points, radius, first).tolist() == sorted(kept)


def test_many_points_in_a_line_are_searched() -> None:
    points = np.zeros((20_000, 3))
    points[:, 1] = np.arange(20_000.0)
    away, which = find_nearest(points, points[::7] + 0.25)
    assert (which == np.arange(20_000)[::7]).all()
    assert away == pytest.approx(0.25 * 3.0**0.5)


def test_no_points_are_an_error() -> None:
    with pytest.raises(ValueError, match="no points"):
        find_nearest(np.empty((0, 3)), np.zeros((1, 3)))
