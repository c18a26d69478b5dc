"""Regions beside, over, behind and around one another, evaluated by B in double precision between samples."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import pacinian as pc

AIR, HEIGHT = pc.Air(speed_of_sound=340.0, density=1.2), 0.2
ARRAYS = {"one": (pc.autd(), 0.3), "nine": (pc.autd(3, 3), 1.5)}  # and a pressure within reach [Pa]
each = pytest.mark.parametrize(("array", "P"), ARRAYS.values(), ids=ARRAYS)


def square(side: float, spacing: float, x: float = 0.0, z: float = 0.0) -> Any:
    """Return points of a square with its edges, relative to a point above the array's middle."""
    s = np.linspace(-side / 2.0, side / 2.0, round(side / spacing) + 1)
    X, Y = np.meshgrid(x + s, s)
    return np.c_[X.ravel(), Y.ravel(), np.full(X.size, z)]


def fine(side: float, x: float = 0.0, z: float = 0.0) -> Any:
    """Return points in a square that are not samples."""
    return square(side, 0.0011, x + 0.0002, z)


def at(array: pc.Array, places: Any) -> Any:
    return places + np.array([*array.centre[:2], HEIGHT])


def solve(array: pc.Array, parts: list[Any], P: list[float], **how: Any) -> pc.Solution:
    """Solve with each part as a region with its own pressure."""
    counts = [len(part) for part in parts]
    t = pc.sound_pressure(np.repeat(P, counts), AIR)
    regions = np.repeat(np.arange(len(parts)), counts)
    return pc.solve(array, at(array, np.concatenate(parts)), t, regions=regions, **how, medium=AIR)


def press(array: pc.Array, solution: pc.Solution, places: Any, asked: float) -> Any:
    """Return the radiation pressure at points, relative to the target."""
    p = pc.matrix(array, at(array, places), AIR) @ solution.gains.astype(complex)
    return pc.radiation_pressure(p, AIR) / asked


def rms(P: Any) -> float:
    return float(np.sqrt(((P - 1.0) ** 2).mean()))


@each
@pytest.mark.parametrize("times", [1.0, 2.0])
def test_regions_side_by_side_are_each_as_strong_as_asked(
    array: pc.Array, P: float, times: float
) -> None:
    """Squares of 12 mm are 3 mm apart. Pressure changes from one to the other over the array's resolution."""
    parts = [square(0.012, 0.003, x) for x in (-0.0075, 0.0075)]
    found = solve(array, parts, [P, times * P])
    assert found.status is pc.Status.ok
    for x, asked in ((-0.0085, P), (0.0085, times * P)):
        made = press(array, found, fine(0.008, x), asked)
        assert made.mean() == pytest.approx(1.0, abs=0.04)
        assert rms(made) < 0.08
    gap = press(array, found, np.c_[np.zeros(9), np.linspace(-5e-3, 5e-3, 9), np.zeros(9)], P)
    assert gap.min() > 0.7


@each
@pytest.mark.parametrize("times", [1.0, 2.0, 4.0])
def test_where_regions_overlap_it_is_as_loud_as_both_in_the_mean(
    array: pc.Array, P: float, times: float
) -> None:
    """The mean of both sound pressures is closest to both. Elsewhere each meets its target, or reports its error."""
    parts = [square(0.015, 0.003, x) for x in (-0.004, 0.004)]
    found = solve(array, parts, [P, times * P])
    both = ((1.0 + times**0.5) / 2.0) ** 2
    assert press(array, found, fine(0.004), P).mean() == pytest.approx(both, rel=0.05)
    alone = [press(array, found, fine(0.005, x), a) for x, a in ((-0.009, P), (0.009, times * P))]
    for made in alone:
        assert made.mean() == pytest.approx(1.0, abs=0.06 * times)
        assert made.min() > 0.5
    assert (found.status is pc.Status.ok) == (times == 1.0)
    assert all(felt.even for felt in found.felt) == (times == 1.0)


@each
@pytest.mark.parametrize("gap", [0.004, 0.0085, 0.05])
def test_of_one_region_behind_another_both_are_there(array: pc.Array, P: float, gap: float) -> None:
    """Closer than the depth resolution they are less even, and that is reported."""
    found = solve(array, [square(0.012, 0.003), square(0.012, 0.003, z=gap)], [P, P])
    for n, z in enumerate((0.0, gap)):
        made = press(array, found, fine(0.01, z=z), P)
        assert made.mean() == pytest.approx(1.0, abs=0.2)
        assert made.min() > 0.5
        assert found.felt[n].force == pytest.approx(made.mean(), abs=0.05)
        assert found.felt[n].holes == 0.0
    even = all(felt.even for felt in found.felt)
    assert (found.status is pc.Status.ok) <= even
    if len(array) > 1000 and gap == 0.05:
        assert found.status is pc.Status.ok


def shell(radius: float, count: int) -> Any:
    """Return even points around a ball, on a spiral."""
    i = np.arange(count) + 0.5
    polar, round_ = np.arccos(1.0 - 2.0 * i / count), np.pi * (1.0 + 5.0**0.5) * i
    flat = np.sin(polar)
    return radius * np.c_[np.cos(round_) * flat, np.sin(round_) * flat, np.cos(polar)]


def half_tube(radius: float, length: float, turns: int, rows: int, inset: float = 0.0) -> Any:
    """Return points of a fingertip from below: half of a cylinder along y."""
    a = np.linspace(inset - np.pi / 2.0, np.pi / 2.0 - inset, turns)
    y = (0.5 - inset) * np.linspace(-length, length, rows)
    A, Y = (grid.ravel() for grid in np.meshgrid(a, y))
    return np.c_[radius * np.sin(A), Y, -radius * np.cos(A)]


CURVED = {
    "a ball": (shell(0.012, 260), shell(0.012, 997)),
    "a finger": (half_tube(0.008, 0.016, 10, 7), half_tube(0.008, 0.016, 31, 23, 0.05)),
}


@each
@pytest.mark.parametrize("what", CURVED)
def test_a_region_that_curves_round_is_even_all_around(
    array: pc.Array, P: float, what: str
) -> None:
    points, between = CURVED[what]
    found = solve(array, [points], [P])
    made = press(array, found, between, P)
    assert found.status is pc.Status.ok
    assert made.mean() == pytest.approx(1.0, abs=0.02)
    assert rms(made) < 0.05
    assert made.min() > 0.8
    assert found.felt[0].force == pytest.approx(made.mean(), abs=0.02)


@each
def test_a_region_that_faces_away_is_left_and_said_to_be_unreachable(
    array: pc.Array, P: float
) -> None:
    """Skin that faces up gets no sound from an array below. The region beside it is unaffected."""
    parts = [square(0.012, 0.003, x) for x in (-0.015, 0.015)]
    down, up = np.array([0.0, 0.0, -1.0]), np.array([0.0, 0.0, 1.0])
    alone = solve(array, parts[:1], [P], facing=pc.SkinFacing(np.tile(up, (25, 1))))
    assert alone.status is pc.Status.unreachable
    assert not alone.gains.any()
    assert alone.felt == (pc.FeltRegion(0.0, 1.0, 1.0, 0.0),)
    facing = pc.SkinFacing(np.repeat([down, up], 25, axis=0))
    found = solve(array, parts, [P, P], facing=facing)
    assert found.status is pc.Status.unreachable
    assert found.felt[0].even
    assert found.felt[1].holes == 1.0
