"""Levels of detail of a skin, compared with a direct computation in NumPy."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pacinian.errors import ArgumentError
from pacinian.scene.hands.skin_lod import SHARERS, SkinNodes, share_pressure, spread_pressure

if TYPE_CHECKING:
    from pacinian.types import Floats

DIRECTIONS = np.array([(0.0, 0.0, 1.0), (0.0, 0.0, -1.0), (0.6, 0.0, 0.8), (0.48, 0.64, 0.6)])


@st.composite
def skins(draw: st.DrawFn) -> SkinNodes:
    """Points on a lattice, so that many distances are equal, or anywhere; on up to three fingers."""
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    N, fingers = draw(st.integers(1, 120)), draw(st.integers(1, 3))
    points = rng.uniform(-0.02, 0.02, (N, 3))
    if draw(st.booleans()):
        points = np.round(points / 2e-3) * 2e-3
    normals = rng.normal(size=(N, 3))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    if draw(st.booleans()):
        normals = DIRECTIONS[rng.integers(0, len(DIRECTIONS), N)]
    return SkinNodes(points, normals, rng.integers(0, fingers, N))


def on_one_side(skin: SkinNodes) -> Floats:
    """Return the cosine between the normals of each two points on the same side, (N, N); 0 for others."""
    other = (skin.fingers[:, None] != skin.fingers) & (skin.fingers[:, None] * skin.fingers > 0)
    return np.where(other, 0.0, np.maximum(skin.normals @ skin.normals.T, 0.0))


def distances(skin: SkinNodes) -> Floats:
    """Return the distance between each two points, (N, N) [m]."""
    return np.linalg.norm(skin.points[:, None] - skin.points, axis=2)


@given(skins(), st.lists(st.floats(1e-3, 0.05), min_size=1, max_size=4))
def test_a_point_that_is_not_chosen_is_near_a_chosen_one(
    skin: SkinNodes, spacings: list[float]
) -> None:
    spacings.sort(reverse=True)
    spread = spread_pressure(skin, spacings)
    apart, same = distances(skin), on_one_side(skin) > 0.0
    assert list(spread.counts) == sorted(spread.counts)
    assert spread.counts[-1] == len(spread.order) == len(set(spread.order.tolist()))
    assert (np.diff(spread.apart) <= 0.0).all()
    for spacing, count, nearest in zip(spacings, spread.counts, spread.nearest, strict=True):
        chosen = spread.order[:count]
        near = np.where(same[:, chosen], apart[:, chosen], np.inf)
        away = near.min(axis=1)
        assert (away < spacing * (1.0 + 1e-9)).all()
        np.testing.assert_allclose(near[np.arange(len(away)), nearest], away, atol=1e-12)
        assert (spread.apart[:count] >= spacing).all()


@given(skins(), st.lists(st.floats(1e-3, 0.05), min_size=2, max_size=4))
def test_the_levels_of_one_run_are_those_of_a_run_for_each(
    skin: SkinNodes, spacings: list[float]
) -> None:
    spacings.sort(reverse=True)
    together = spread_pressure(skin, spacings)
    for level, spacing in enumerate(spacings):
        alone = spread_pressure(skin, [spacing])
        count = together.counts[level]
        assert alone.counts == (count,)
        np.testing.assert_array_equal(alone.order, together.order[:count])
        np.testing.assert_array_equal(alone.apart, together.apart[:count])
        np.testing.assert_array_equal(alone.nearest[0], together.nearest[level])


@given(skins(), st.data(), st.sampled_from([1e-5, 2e-3, 0.01, 10.0]))
def test_a_point_is_shared_by_the_nearest_nodes_on_its_side(
    skin: SkinNodes, data: st.DataObject, spacing: float
) -> None:
    spread = spread_pressure(skin, [1e-9])
    skin = skin.only(spread.order)  # all places; at least one node on each side comes first
    nodes = data.draw(st.integers(int((spread.apart > 1.0).sum()), len(skin.points)))
    share = share_pressure(skin, nodes, spacing)
    cosine, apart = on_one_side(skin)[:, :nodes], distances(skin)[:, :nodes]
    with np.errstate(divide="ignore", invalid="ignore"):
        D = np.where(cosine > 0.0, apart / np.sqrt(cosine), np.inf)
    for k in range(nodes, len(skin.points)):
        near = np.sort(D[k])[: SHARERS + 1]
        if near[0] < 1e-9 or not np.isfinite(near[0]):
            continue  # on a node; or on a side without one
        beyond = 1.0 / near[SHARERS] if len(near) > SHARERS else 0.0
        weights = np.array([max(1.0 / d - beyond, 0.0) ** 2 for d in near[:SHARERS]])
        if weights.sum() < 1e-6 / near[0] ** 2:
            continue  # four nodes at the same distance share in equal parts
        found = share.weights[k]
        np.testing.assert_allclose(
            np.sort(found)[::-1][: len(weights)], weights / weights.sum(), atol=1e-3
        )
        np.testing.assert_allclose(
            D[k][share.indices[k]][found > 1e-3],
            near[:SHARERS][: int((found > 1e-3).sum())],
            rtol=1e-9,
        )


def test_points_that_are_not_finite_are_refused() -> None:
    skin = SkinNodes(np.full((2, 3), np.nan), np.ones((2, 3)), np.zeros(2, np.intp))
    with pytest.raises(ArgumentError, match="`points` must be finite"):
        spread_pressure(skin, [1.0])
