"""Wrong regions give a clear error, and degenerate ones a defined result."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import pacinian as pc
from pacinian.scene.sampling.region_bands import FADING
from pacinian.scene.sampling.sample_budget import ALONE
from pacinian.testing import ManualClock

ARRAY, AIR = pc.autd(), pc.Air()
X, Y, _ = ARRAY.centre.tolist()
ROW = np.c_[X + 0.003 * np.arange(6), np.full(6, Y), np.full(6, 0.15)]
T = np.full(6, 100.0)

WRONG: dict[str, Any] = {
    "too few": [0, 0],
    "one for all": 0,
    "two dimensions": [[0] * 6],
    "floats": [0.0] * 6,
    "NaN": [np.nan] * 6,
    "NaN for isolated": [0, 0, 0, np.nan, 0, 0],
    "infinity": [np.inf] * 6,
    "flags": [True] * 6,
    "complex": 1j * np.arange(6),
    "names": ["palm"] * 6,
    "nothing": [None] * 6,
    "ragged": [0, 0, 0, 0, 0, [0]],
    "-3": [0, 0, 0, 0, 0, -3],
    "the least of all": [-(2**63)] * 6,
    "too large to count": [2**70] * 6,
}


@pytest.mark.parametrize("regions", WRONG.values(), ids=WRONG)
def test_wrong_regions_are_refused_and_the_session_goes_on(regions: Any) -> None:
    session = pc.Session(ARRAY)
    before = session.solve(ROW, T, regions=[0] * 6)
    for solve in (session.solve, lambda *given, **more: pc.solve(ARRAY, *given, **more)):
        for points, amplitudes in ((ROW, T), (ROW.tolist(), T.tolist())):
            with pytest.raises(pc.ArgumentError, match="regions"):
                solve(points, amplitudes, regions=regions)
    after = session.solve(ROW, T, regions=[0] * 6)
    assert np.array_equal(after.gains, before.gains)


@pytest.mark.parametrize(
    "regions",
    [
        [5, 5, 5, 9, 9, 9],
        (2**40, 2**40, 2**40, 2**62, 2**62, 2**62),
        np.repeat([2**63, 2**64 - 1], 3).astype(np.uint64),
        np.repeat([0, 127], 3).astype(np.int8),
    ],
    ids=["small", "huge", "unsigned", "bytes"],
)
def test_which_are_alike_matters_and_not_how_large_the_numbers_are(regions: Any) -> None:
    found = pc.solve(ARRAY, ROW, T, regions=regions)
    assert np.array_equal(found.gains, pc.solve(ARRAY, ROW, T, regions=[0, 0, 0, 1, 1, 1]).gains)
    assert len(found.felt) == 2


@pytest.mark.parametrize("region", [[-2] * 6, [0, 0, 0, -2, -2, -2]], ids=["without", "with"])
def test_sound_beside_is_refused_with_and_without_a_region(region: Any) -> None:
    with pytest.raises(pc.ArgumentError, match="-2"):
        pc.solve(ARRAY, ROW, T, regions=region)


@pytest.mark.parametrize("bad", [np.nan, np.inf, 1e6])
def test_a_region_with_a_point_that_is_nowhere_is_refused(bad: float) -> None:
    points = ROW.copy()
    points[3, 1] = bad
    with pytest.raises(pc.ArgumentError, match="points"):
        pc.solve(ARRAY, points, T, regions=[0] * 6)


# ---------------------------------------------------------------------- hardly any region


def square(count: int, spacing: float, height: float) -> Any:
    side = spacing * (np.arange(count) - (count - 1) / 2.0)
    A, B = np.meshgrid(X + side, Y + side)
    return np.c_[A.ravel(), B.ravel(), np.full(count * count, height)]


def whole(points: Any, pressure: float = 0.3) -> pc.Solution:
    t = pc.sound_pressure(np.full(len(points), pressure), AIR)
    return pc.solve(ARRAY, points, t, regions=np.zeros(len(points), int))


@pytest.mark.parametrize("count", [1, 2, 7])
def test_a_region_without_an_area_is_what_one_point_is(count: int) -> None:
    place = np.array([[X, Y, 0.15]])
    found, t = whole(place.repeat(count, axis=0)), float(pc.sound_pressure(0.3, AIR))
    assert np.abs(found.sound_pressure) == pytest.approx(t, rel=0.01)
    assert found.status is pc.Status.ok
    assert found.felt[0].force == pytest.approx(1.0, abs=0.02)
    B = pc.matrix(ARRAY, place, AIR)[0]
    least = t * B.conj() / np.vdot(B, B).real  # the gains of least power
    alike = abs(np.vdot(least, found.gains)) / np.linalg.norm(least) / np.linalg.norm(found.gains)
    assert alike > 0.9999


def test_a_region_of_ten_metres_is_not_said_to_be_met() -> None:
    found = whole(square(11, 1.0, 0.15), 20.0)
    assert found.status in (pc.Status.limited, pc.Status.unreachable)
    assert not found.felt[0].even
    assert np.abs(found.gains).max() <= 1.0


def test_a_region_at_the_array_s_own_place() -> None:
    """On transducers it is rejected. Between them, and 0.5 mm above them, it has a result."""
    with pytest.raises(pc.PointOnTransducer):
        whole(ARRAY.positions[:9])
    between = (ARRAY.positions[0] + ARRAY.positions[1]) / 2.0
    for height in (0.0, 5e-4):
        found = whole(square(5, 0.0017, 0.0) - [X, Y, 0.0] + between + [0.0, 0.0, height])
        assert np.isfinite(found.gains).all()
        assert np.isfinite(found.sound_pressure).all()
        assert np.abs(found.gains).max() <= 1.0
        assert all(np.isfinite(felt).all() for felt in found.felt)


# ---------------------------------------------------------------------- from a scene


def mesh(vertices: Any, faces: Any) -> pc.Mesh:
    return pc.Mesh(vertices=vertices, faces=faces)


def boxes() -> pc.Mesh:
    """Return two intersecting boxes of 20 mm as one mesh."""
    corners = 0.01 * np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], float)
    sides = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    faces = np.array([t for a, b, c, d in sides for t in ((a, b, c), (a, c, d))])
    other = corners + np.array([0.008, 0.004, 0.003])
    return mesh(np.concatenate([corners, other]), np.concatenate([faces, faces + 8]))


def crossing() -> pc.Mesh:
    """Return two intersecting triangles."""
    z = np.zeros(4)
    flat = 0.02 * np.c_[[-1.0, 1.0, -1.0, 1.0], [-0.5, 0.5, 0.5, -0.5], z]
    return mesh(flat, np.array([[0, 1, 2], [0, 1, 3]]))


@pytest.mark.parametrize("make", [boxes, crossing])
def test_a_mesh_that_goes_through_itself_is_an_even_region(make: Any) -> None:
    sampler = pc.Sampler(300)
    sampler.prepare(ARRAY, AIR)
    item = pc.Surface(shape=make(), pose=pc.Pose((X, Y, 0.15)), radiation_pressure=0.3)
    samples = sampler.sample(pc.Scene((item,)))
    assert len(np.unique(samples.regions)) == 1
    t = pc.sound_pressure(samples.radiation_pressure, AIR)
    found = pc.solve(ARRAY, samples.positions, t, regions=samples.regions)
    assert found.status is pc.Status.ok
    assert found.felt[0].even


def test_a_mesh_without_an_area_is_refused() -> None:
    line = np.array([[0.0, 0.0, 0.0], [0.01, 0.0, 0.0], [0.02, 0.0, 0.0]])
    with pytest.raises(pc.ArgumentError, match="no area"):
        pc.Surface(shape=mesh(line, np.array([[0, 1, 2]])), radiation_pressure=0.3)


SHAPES = {
    "at the array": (pc.Rectangle(0.05, 0.05), 0.0),
    "10 m wide": (pc.Rectangle(10.0, 10.0), 0.15),
    "of 10 m, around the array": (pc.Sphere(5.0), 0.15),
    "of a micrometre": (pc.Disc(1e-6), 0.15),
}


@pytest.mark.parametrize("what", SHAPES)
def test_the_loop_plays_any_of_them_within_the_limit(what: str) -> None:
    shape, height = SHAPES[what]
    pose = pc.Pose((X, Y, height))
    scene = pc.Scene((pc.Surface(shape=shape, pose=pose, radiation_pressure=0.3),))
    renderer = pc.Renderer(ARRAY, scene, clock=ManualClock())
    with renderer:
        for k in range(10):
            renderer.tick(1e-3 * k)
        assert renderer.halted is None
        sent = renderer.last_frame.gains(renderer.backend.capability)
        assert np.isfinite(sent).all()
        assert np.abs(sent).max() <= 1.0 + 1e-6
        assert (
            len(renderer.played.rows[0].samples)
            <= FADING * ALONE.shares[-1] * renderer.sampler.budget
        )
        status = renderer.played.rows[0].solution.status
    wanted = {"of a micrometre": pc.Status.ok, "10 m wide": pc.Status.limited}
    assert status is wanted.get(what, pc.Status.unreachable)
