"""The area of a focus: against its radiation pressure, integrated over the main lobe by other code."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

import pacinian as pc

if TYPE_CHECKING:
    from pacinian.types import Complexes, Floats

K = 2.0 * np.pi * 40e3 / pc.Air().speed_of_sound  # [rad/m]
ANGLES, FAR = 16, 0.045  # number of directions from a focus, and their length [m]


def flat(places: Floats) -> pc.Array:
    up = np.tile([0.0, 0.0, 1.0], (len(places), 1))
    return pc.Array(np.c_[places, np.zeros(len(places))], up, pc.T4010A1)


GRID = pc.lattice(0.16, 0.16).replace_transducer(pc.T4010A1)
FOUR = pc.autd(2, 2)
ARRAYS = {
    "one unit": pc.autd(),
    "nine units": pc.autd(3, 3),
    "grid": GRID,
    "sparse": FOUR.remove_transducers(np.random.default_rng(3).random(len(FOUR)) > 0.3),
    "random": flat(np.random.default_rng(4).uniform(-0.1, 0.1, (256, 2))),
    "folded": GRID.fold("x", math.radians(30.0)),
}
PLACES: dict[
    str, tuple[Any, float]
] = {  # offset from the array's centre, height above it [m], tilt of the skin [rad]
    "low": ((0.0, 0.0, 0.08), 0.0),
    "usual": ((0.0, 0.0, 0.2), 0.0),
    "high": ((0.0, 0.0, 0.4), 0.0),
    "beside, tilted": ((0.06, 0.03, 0.2), -0.4),
    "tilted": ((0.0, 0.0, 0.15), 0.5),
}


def heard(array: pc.Array, q: Floats, normal: Floats) -> Complexes:
    """Return the pressure of each transducer along the normal at points q (K, 3): (K, N), with 1 Pa at 1 m."""
    d = q[:, None] - array.positions
    away = np.linalg.norm(d, axis=2)
    D = array.transducer.directivity((d * array.normals).sum(axis=2) / away)
    return np.asarray(D / away * np.exp(-1j * K * away) * np.maximum(-(d @ normal) / away, 0.0))


def integrated(array: pc.Array, q: Floats, normal: Floats) -> Floats:
    """Integrate the radiation pressure relative to that at q [m^2], in each direction up to its first minimum.

    Returns the areas for equal drives, and for drives in proportion to the pressure at q, (2,).
    """
    b = heard(array, q[None], normal)[0]
    gains = np.stack([np.exp(-1j * np.angle(b)), b.conj()], axis=1)
    across = np.cross(normal, [0.0, 1.0, 0.0])
    across /= np.linalg.norm(across)
    r, total = np.linspace(0.0, FAR, 81), np.zeros(2)
    for angle in np.arange(ANGLES) * 2.0 * np.pi / ANGLES:
        way = math.cos(angle) * across + math.sin(angle) * np.cross(normal, across)
        both = np.abs(heard(array, q + r[:, None] * way, normal) @ gains) ** 2
        for k, P in enumerate(both.T):
            rises = np.flatnonzero(np.diff(P) > 0.0)
            end = int(rises[0]) + 1 if len(rises) else len(r)
            total[k] += np.trapezoid(P[:end] * r[:end], r[:end]) / P[0] * 2.0 * np.pi / ANGLES
    return total


@pytest.mark.parametrize("place", PLACES)
@pytest.mark.parametrize("name", ARRAYS)
def test_it_is_the_integral_over_the_main_lobe(name: str, place: str) -> None:
    array, (at, tilt) = ARRAYS[name], PLACES[place]
    q = array.centre * [1.0, 1.0, 0.0] + at
    normal = np.array([math.sin(tilt), 0.0, -math.cos(tilt)])
    found = [
        pc.focal_area(array, q[None], pc.Air(), normal[None], uniform=even)[0]
        for even in (True, False)
    ]
    tolerance = 0.15 if name == "folded" else 0.07
    assert integrated(array, q, normal) == pytest.approx(np.array(found), rel=tolerance)


def test_without_a_normal_it_lies_across_the_way_of_the_sound() -> None:
    for beside in (0.0, 0.1):
        q = np.array([[beside, 0.0, 0.25]])
        way = pc.autd().centre - q
        facing = way / np.linalg.norm(way)
        (free,), (turned,) = (pc.focal_area(pc.autd(), q, pc.Air(), n) for n in (None, facing))
        assert free == pytest.approx(
            turned, rel=0.08
        )  # without cosines, which make the array look narrower


def test_a_longer_wave_makes_a_larger_spot_and_turning_everything_changes_nothing() -> None:
    q, n = np.array([[0.03, 0.02, 0.2]]), np.array([[0.0, 0.0, -1.0]])
    (here,) = pc.focal_area(pc.autd(), q, pc.Air(), n)
    slow, fast = (pc.focal_area(pc.autd(), q, pc.Air(speed_of_sound=c), n)[0] for c in (300, 360))
    assert fast / slow == pytest.approx(1.44)
    pose = pc.Pose((0.5, -0.3, 0.2)).rotate("y", math.radians(50.0))
    turned = pc.focal_area(pc.autd().transform(pose), pose.points(q), pc.Air(), n @ pose.matrix.T)
    assert turned[0] == pytest.approx(here, rel=1e-3)


def test_where_no_focus_can_be_it_is_infinite() -> None:
    one, line = pc.Array([[0.0, 0.0, 0.0]]), pc.Array([[0.0, 0.0, 0.0], [0.01, 0.0, 0.0]])
    for array in (one, line):
        assert np.isinf(pc.focal_area(array, [[0.0, 0.0, 0.2]], pc.Air())).all()
    assert np.isinf(pc.focal_area(pc.autd(), [[0.08, 0.06, -0.2]], pc.Air())).all()  # behind
    assert np.isinf(
        pc.focal_area(pc.autd(), [[0.08, 0.06, 0.2]], pc.Air(), [[0.0, 0.0, 1.0]])
    ).all()
    assert pc.focal_area(pc.autd(), np.empty((0, 3)), pc.Air()).shape == (0,)
    with pytest.raises(pc.PointOnTransducer):
        pc.focal_area(one, [[0.0, 0.0, 0.0]], pc.Air())
    with pytest.raises(pc.ArgumentError, match="normals"):
        pc.focal_area(pc.autd(), [[0.0, 0.0, 0.2]], pc.Air(), np.zeros((2, 3)))
