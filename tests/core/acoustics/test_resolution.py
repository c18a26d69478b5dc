"""The resolution of an array, against the focus that it makes."""

from __future__ import annotations

import math

import numpy as np
import pytest

import pacinian as pc
from pacinian.acoustics.resolution import find_lobe, resolution

AIR = pc.Air(speed_of_sound=340.0)
WAVELENGTH = 340.0 / 40e3


def first_null(
    array: pc.Array, q: np.ndarray, angles: tuple[float, ...] = tuple(range(0, 180, 15))
) -> float:
    """Return the distance from a focus at q to the nearest first minimum of the field, at angles [deg] from x."""
    b = pc.matrix(array, q[None], pc.Air())[0]
    g = b.conj() / np.abs(b).max()
    d = np.linspace(0.0, 0.05, 2001)
    found = []
    for angle in np.radians(angles):
        way = np.array([np.cos(angle), np.sin(angle), 0.0])
        p = np.abs(pc.field(array, g, q + d[:, None] * way, medium=pc.Air()))
        found.append(d[1 + np.flatnonzero((p[1:-1] < p[:-2]) & (p[1:-1] <= p[2:]))[0]])
    return float(min(found))


@pytest.mark.parametrize(("units", "heights"), [(1, (0.1, 0.2, 0.5)), (3, (0.1, 0.2, 0.45, 0.6))])
def test_it_is_where_the_main_lobe_of_a_focus_ends(units: int, heights: tuple[float, ...]) -> None:
    array = pc.autd(units, units)
    for z in heights:
        q = np.array([0.02, -0.01, z])
        assert resolution(array, [q], pc.Air())[0] == pytest.approx(first_null(array, q), rel=0.15)


@pytest.mark.parametrize(("units", "long_side"), [((2, 1), 0.0), ((1, 2), 90.0), ((4, 1), 0.0)])
def test_an_elongated_array_has_a_wide_lobe_along_its_short_side(
    units: tuple[int, int], long_side: float
) -> None:
    array = pc.autd(*units)
    q = array.centre + np.array([0.0, 0.0, 0.2])
    short, long = find_lobe(array, q[None], pc.Air())[0]
    assert short == pytest.approx(first_null(array, q, (long_side,)), rel=0.2)
    assert long == pytest.approx(first_null(array, q, (long_side + 90.0,)), rel=0.2)


def test_directions_that_spread_evenly_make_a_sinc() -> None:
    """Transducers on an arc: their directions' sines are -s..s, and the first null is at lambda / 2 s."""
    for s in (0.1, 0.3, 0.7):
        sine = np.linspace(-s, s, 2001)
        arc = 0.2 * np.stack([sine, np.zeros(2001), 1 - np.sqrt(1 - sine**2)], -1)
        found = resolution(pc.Array(arc), [[0.0, 0.0, 0.2]], AIR)[0]
        assert found == pytest.approx(WAVELENGTH / (2 * s), rel=1e-3)


def test_moving_and_turning_everything_changes_nothing() -> None:
    pose = pc.Pose((0.5, -0.3, 0.2)).rotate("y", math.radians(50.0))
    array, q = pc.autd(2, 1), np.array([[0.0, 0.0, 0.2], [0.1, 0.05, 0.3]])
    here = resolution(array, q, AIR)
    np.testing.assert_allclose(
        resolution(array.transform(pose), pose.points(q), AIR), here, rtol=1e-4
    )
    louder = array.replace_transducer(pc.Transducer(pressure=1e3, directivity=pc.t4010a1))
    np.testing.assert_allclose(resolution(louder, q, AIR), here, rtol=1e-6)
    warm = pc.Air(speed_of_sound=380.0)
    np.testing.assert_allclose(resolution(array, q, warm), here * 380.0 / 340.0, rtol=1e-6)


def test_more_units_and_less_height_resolve_more() -> None:
    z = np.c_[np.zeros((5, 2)), [0.1, 0.2, 0.3, 0.4, 0.6]]
    one, nine = resolution(pc.autd(), z, pc.Air()), resolution(pc.autd(3, 3), z, pc.Air())
    assert (np.diff(one) > 0).all()
    assert (np.diff(nine) > 0).all()
    assert (nine < one).all()
    assert (nine > WAVELENGTH / 2 / np.sqrt(3)).all()


def test_where_nothing_is_heard_nothing_is_resolved() -> None:
    behind = resolution(pc.autd(), [[0.0, 0.0, -0.1], [0.0, 0.0, 0.1]], pc.Air())
    assert np.isinf(behind[0])
    assert np.isfinite(behind[1])
    assert np.isinf(resolution(pc.Array([[0.0, 0.0, 0.0]]), [[0.0, 0.0, 0.1]], pc.Air())).all()
    assert resolution(pc.autd(), np.empty((0, 3)), pc.Air()).shape == (0,)
    with pytest.raises(pc.ArgumentError, match="points"):
        resolution(pc.autd(), [0.0, 0.0, 0.1], pc.Air())
    with pytest.raises(pc.PointOnTransducer):
        resolution(pc.autd(), [pc.autd().positions[5]], pc.Air())
