"""Grids, discs and balls of points: counts, extents and spacing by their own geometry."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial import KDTree

import pacinian as pc

LENGTHS = st.floats(0.001, 0.1)


def nearest(points: Any) -> Any:
    return KDTree(points).query(points, 2)[0][:, 1]


@given(
    st.lists(st.just(0.0) | st.floats(1e-4, 0.05), min_size=2, max_size=3), st.floats(0.005, 0.1)
)
def test_a_grid_spans_its_size_in_equal_steps(size: list[float], spacing: float) -> None:
    points = pc.grid(size, spacing, (0.1, -0.2, 0.3))
    extents = [*size, 0.0][:3]
    assert np.ptp(points, axis=0) == pytest.approx(extents, abs=1e-12)
    assert (points.max(axis=0) + points.min(axis=0)) / 2 == pytest.approx([0.1, -0.2, 0.3])
    for axis, extent in enumerate(extents):
        places = np.unique(points[:, axis].round(12))
        assert len(places) == max(1, math.ceil(extent / spacing - 1e-9) + 1 if extent else 1)
        if len(places) > 1:
            assert np.diff(places) == pytest.approx(extent / (len(places) - 1))


def test_x_varies_fastest_so_that_a_grid_can_be_reshaped() -> None:
    points = pc.grid((0.02, 0.01, 0.03), 0.01).reshape(4, 2, 3, 3)
    assert points[0, 0, :, 0] == pytest.approx([-0.01, 0.0, 0.01])
    assert points[0, :, 0, 1] == pytest.approx([-0.005, 0.005])
    assert points[:, 0, 0, 2] == pytest.approx([-0.015, -0.005, 0.005, 0.015])


@given(LENGTHS, st.floats(0.002, 0.02))
def test_a_ball_holds_all_grid_points_within_its_radius(radius: float, spacing: float) -> None:
    points = pc.ball(radius, spacing, (0.0, 0.0, 0.2)) - [0.0, 0.0, 0.2]
    K = int(radius / spacing) + 2
    every = spacing * np.stack(np.meshgrid(*[np.arange(-K, K + 1)] * 3), axis=-1).reshape(-1, 3)
    away = np.linalg.norm(every, axis=1)
    inner, outer = (away < radius * (1 - 1e-6)).sum(), (away < radius * (1 + 1e-6)).sum()
    assert inner <= len(points) <= outer
    assert np.linalg.norm(points, axis=1).max() <= radius * (1 + 1e-6)
    assert np.linalg.norm(points, axis=1).min() == pytest.approx(0.0, abs=1e-12)


@given(LENGTHS, st.floats(0.001, 0.02))
def test_no_place_of_a_disc_is_far_from_a_point(radius: float, spacing: float) -> None:
    points = pc.disc(radius, spacing, (0.0, 0.1, 0.2))
    assert (points[:, 2] == 0.2).all()
    rng = np.random.default_rng(1)
    r, phi = radius * np.sqrt(rng.random(500)), 2 * np.pi * rng.random(500)
    places = np.stack([r * np.cos(phi), 0.1 + r * np.sin(phi), np.full(500, 0.2)], axis=1)
    assert KDTree(points).query(places)[0].max() <= spacing
    assert np.linalg.norm(points - [0.0, 0.1, 0.2], axis=1).max() == pytest.approx(radius)


@pytest.mark.parametrize(
    ("make", "argument"),
    [
        (lambda: pc.grid(0.1, 0.01), "size"),
        (lambda: pc.grid((0.1,), 0.01), "size"),
        (lambda: pc.grid((0.1, math.nan), 0.01), "size"),
        (lambda: pc.grid((0.1, -0.1), 0.01), "size"),
        (lambda: pc.grid((100.0, 100.0), 10.0), "size"),  # millimetres
        (lambda: pc.grid("wide", 0.01), "size"),
        (lambda: pc.grid((0.1, 0.1), 0.0), "spacing"),
        (lambda: pc.grid((0.1, 0.1), math.inf), "spacing"),
        (lambda: pc.grid((1.0, 1.0, 1.0), 0.001), "spacing"),
        (lambda: pc.grid((0.1, 0.1), 0.01, (0.0, 0.2)), "centre"),
        (lambda: pc.disc(0.0, 0.01), "radius"),
        (lambda: pc.disc(1.0, 1e-5), "spacing"),
        (lambda: pc.disc(20.0, 1.0), "radius"),
        (lambda: pc.ball(math.nan, 0.01), "radius"),
        (lambda: pc.ball(0.1, 1e-9), "spacing"),
        (lambda: pc.ball(1.0, 0.001), "spacing"),
        (lambda: pc.ball(0.1, 0.01, "here"), "centre"),
    ],
)
def test_bad_arguments_are_named(make: Any, argument: str) -> None:
    with pytest.raises(pc.ArgumentError) as caught:
        make()
    assert caught.value.argument == argument


def test_points_can_be_asked_for_and_heard() -> None:
    array, air = pc.autd(), pc.Air()
    points = pc.disc(0.01, 0.005, (0.0, 0.0, 0.2))
    solution = pc.solve(array, points, 100.0, regions=np.zeros(len(points), int), medium=air)
    assert solution.field(pc.grid((0.02, 0.02), 0.01, (0.0, 0.0, 0.2))).shape == (9,)
