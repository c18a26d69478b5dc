"""The error slice near regions, against independent sums over all transducers."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

import pacinian as pc
from pacinian.acoustics.skin_facing import SkinFacing
from pacinian.scene.hands.capsules import make_capsules
from pacinian.solving.felt_figures import FeltRegion
from pacinian.viewing.region_error import (
    Regions,
    compute_error,
    compute_felt_and_asked,
    nearest_places,
)
from pacinian.wire.binary_arrays import pack

from ..core.client.fake_server import state

if TYPE_CHECKING:
    from pacinian.types import Floats

ARRAY, AIR = pc.autd(), pc.Air()
GAP = 0.003  # spacing of the samples [m]
UP = np.array([0.0, 0.0, 1.0])
GRID = np.stack(
    [*np.meshgrid(GAP * np.arange(5.0), GAP * np.arange(4.0), indexing="ij"), np.full((5, 4), 0.2)],
    axis=-1,
).reshape(-1, 3)
"""Samples of a rectangle from (0, 0) to (12, 9) mm, 0.2 m above the array."""
TWO = np.exp(1j * np.random.default_rng(0).uniform(0.0, 6.0, (2, 249))).astype(np.complex64)


def regions(
    points: Floats,
    asked: Floats,
    normals: Floats | None = None,
    /,
    strength: float = 1.0,
    **more: Any,
) -> Regions:
    """Return the regions of one object. strength: mean over the modulation."""
    made = {
        "points": pack(points),
        "normals": pack(np.tile(UP, (len(points), 1)) if normals is None else normals),
        "asked": pack(asked),
        "index": bytes(4 * len(points)),
        "felt": pack([[1.0, 0.0, 0.0, 0.0]]),
        **more,
    }
    found = Regions.of(state(**made), np.array([strength, 1.0]))
    assert found is not None
    return found


def test_places_are_inside_of_the_outline_or_3_to_5_mm_beside_and_on_the_surface() -> None:
    slope = 1.0 + 100.0 * GRID[:, 0]
    at = 1e-3 * np.array(
        [
            [4.5, 4.5, 200.0],  # between four samples
            [4.5, 4.5, 203.0],  # above that point
            [4.5, 4.5, 206.0],  # too far above it
            [6.0, 3.0, 200.0],  # on a sample
            [4.5, 0.0, 200.0],  # on the outline
            [4.5, -1.0, 200.0],  # just outside
            [6.0, -4.0, 201.0],  # beside
            [6.0, -6.0, 200.0],  # too far beside
        ]
    )
    found = nearest_places(at, UP, regions(GRID, slope))
    assert found.rows.tolist() == [0, 1, 3, 4, 6]
    np.testing.assert_allclose(found.asked, [1.45, 1.45, 1.6, 1.45, 0.0], atol=1e-4)
    np.testing.assert_allclose(found.points[:, 2], 0.2, atol=1e-7)
    np.testing.assert_allclose(found.points[:, :2], at[found.rows, :2], atol=1e-7)


def test_a_hole_between_samples_is_outside() -> None:
    turns = np.linspace(0.0, 2.0 * np.pi, 16, endpoint=False)
    ring = 0.01 * np.stack([np.cos(turns), np.sin(turns), np.full(16, 20.0)], axis=-1)
    at = np.array([[0.0, 0.0, 0.2], [0.006, 0.0, 0.2], [0.01, 0.0, 0.2]])
    found = nearest_places(at, UP, regions(ring, np.ones(16)))
    assert found.rows.tolist() == [1, 2]
    assert found.asked.tolist() == [0.0, 1.0]


def test_what_is_modulated_is_asked_for_on_average() -> None:
    index = (np.arange(20) >= 10).astype("<i4").tobytes()
    felt = pack([[1.0, 0.0, 0.0, 0.0]] * 2)
    told = regions(GRID, np.full(20, 8.0), strength=0.25, index=index, felt=felt)
    asked = np.frombuffer(told.asked, "<f4")
    assert asked.tolist() == [2.0] * 10 + [8.0] * 10


def test_isolated_samples_are_no_region() -> None:
    points = np.vstack([GRID, [[0.02, 0.0, 0.2]]])
    index = np.append(np.zeros(len(GRID)), 1).astype("<i4").tobytes()
    felt = pack([[1.0, 0.0, 0.0, 0.0], [np.nan] * 4])
    found = nearest_places(points, UP, regions(points, np.ones(21), index=index, felt=felt))
    assert found.rows.tolist() == list(range(20))
    assert Regions.of(state(felt=felt[16:], index=bytes(4)), np.ones(1)) is None
    assert Regions.of(state(), np.ones(0)) is None


@pytest.mark.parametrize(
    "wrong",
    [
        {"points": bytes(12)},
        {"normals": b""},
        {"asked": bytes(7)},
        {"index": np.full(20, 3, "<i4").tobytes()},
        {"felt": bytes(8)},
        {"hands": bytes(12)},
        {"points": pack(np.full((20, 3), np.inf))},
        {"hands": pack(np.full((26, 3), np.nan))},
    ],
)
def test_a_damaged_state_is_refused(wrong: dict[str, bytes]) -> None:
    with pytest.raises((ValueError, IndexError)):
        regions(GRID, np.ones(20), **wrong)


def test_the_error_is_the_mean_of_all_frames_less_what_was_asked() -> None:
    at = GRID + np.array([0.001, 0.001, 0.002])
    told = regions(GRID, np.full(20, 5.0))
    places = nearest_places(at, UP, told)
    assert (places.asked > 0.0).sum() == 12
    p = np.array([pc.field(ARRAY, g, places.points, AIR, "double") for g in TWO])
    wanted = pc.radiation_pressure(p, AIR).mean(axis=0) - places.asked
    found = compute_error(ARRAY, AIR, TWO, at, UP, told)
    assert np.isnan(found).sum() == len(at) - len(places.rows)
    np.testing.assert_allclose(found[places.rows], wanted, atol=1e-3 * np.abs(wanted).max())
    silent = compute_error(ARRAY, AIR, TWO[:0], at, UP, told)
    np.testing.assert_array_equal(silent[places.rows], -places.asked)


def test_on_skin_sound_counts_along_the_normal_less_what_the_hand_hides() -> None:
    hand = pc.Hand.open("right", pc.Pose((0.0, -0.03, 0.215)))
    assert hand.joints is not None
    tilted = np.tile([0.6, 0.0, -0.8], (20, 1))
    told = regions(GRID, np.full(20, 5.0), tilted, hands=pack(hand.joints))
    at = GRID + np.array([0.001, 0.001, 0.0])
    places = nearest_places(at, UP, told)
    assert len(places.rows) > 10
    weights = SkinFacing(places.normals, make_capsules(hand)).weights(
        places.points, ARRAY.positions
    )
    each = np.array([pc.field(ARRAY, g, places.points, AIR, "double") for g in np.eye(249)]).T
    p = ((weights * each)[None] * TWO[:, None].astype(complex)).sum(axis=2)
    wanted = pc.radiation_pressure(p, AIR).mean(axis=0) - places.asked
    found = compute_error(ARRAY, AIR, TWO, at, UP, told)[places.rows]
    np.testing.assert_allclose(found, wanted, atol=2e-3 * np.abs(wanted).max())


def test_a_slice_through_a_region_has_the_figures_that_are_felt() -> None:
    """The solution's own figures come from other points, halfway between samples."""
    array, asked = pc.autd(3, 3), 5.0
    x = GAP * (np.arange(11) - 5.0)
    samples = np.stack([*np.meshgrid(x, x), np.full((11, 11), 0.2)], axis=-1).reshape(-1, 3)
    pressures = np.full(121, pc.sound_pressure(asked, AIR))
    solution = pc.solve(array, samples, pressures, medium=AIR, regions=np.zeros(121, int))
    assert solution.felt is not None
    told = regions(samples, np.full(121, asked))
    y = 0.0004 * (np.arange(100) - 49.5)
    at = np.stack([*np.meshgrid(y, y), np.full((100, 100), 0.2)], axis=-1).reshape(-1, 3)
    found = compute_error(array, AIR, solution.gains[None], at, UP, told)
    inside = np.abs(at).max(axis=1, initial=0.0, where=[True, True, False]) < 0.015
    e, beside = found[inside], found[~inside]
    felt = FeltRegion(
        1.0 + e.mean() / asked, np.sqrt((e * e).mean()) / asked, 0.0, np.nanmax(beside) / asked
    )
    wanted = solution.felt[0]
    assert felt.force == pytest.approx(wanted.force, abs=0.01)
    assert felt.rms == pytest.approx(wanted.rms, abs=0.01)
    assert felt.spill == pytest.approx(wanted.spill, rel=0.1)


def test_felt_and_asked_are_those_of_the_contact_behind_each_point_of_a_plane() -> None:
    hollow = GRID + 40.0 * ((GRID[:, :2] - 0.005) ** 2).sum(axis=1)[:, None] * UP  # up to 3 mm deep
    asked = 2.0 + 100.0 * GRID[:, 0]
    known = regions(hollow, asked)
    before = GRID + 0.03 * UP  # 30 mm before the contact, far beyond the range of an error slice
    felt, wanted = compute_felt_and_asked(ARRAY, AIR, TWO, before, UP, known)
    np.testing.assert_allclose(wanted, asked, rtol=1e-2)
    P = np.mean(
        [pc.radiation_pressure(pc.field(ARRAY, g, hollow, AIR, "double"), AIR) for g in TWO], axis=0
    )
    np.testing.assert_allclose(felt, P, rtol=2e-2, atol=1e-2 * P.max())
    aside = before + np.array([0.05, 0.0, 0.0])
    assert np.isnan(compute_felt_and_asked(ARRAY, AIR, TWO, aside, UP, known)).all()
