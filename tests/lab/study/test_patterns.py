"""Patterns and planes."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import pacinian as pc
from pacinian_lab.paper import experiment
from pacinian_lab.study.patterns import (
    FORMS,
    Circle,
    Focus,
    Letters,
    Pattern,
    PointGrid,
    Points,
    RandomPoints,
    Shape,
)
from pacinian_lab.study.planes import Plane


def made(pattern: Pattern, seed: int = 0) -> tuple[np.ndarray, np.ndarray]:
    return pattern.make(np.random.default_rng(seed))


@pytest.mark.parametrize("form", experiment.PATTERNS)
def test_shapes_are_the_papers_sample_by_sample(form: str) -> None:
    uv, proportions = made(Shape(form=form))
    assert np.array_equal(proportions, experiment.pattern(form).ravel())
    for plane, case in (
        (Plane(z=0.2), "1a"),
        (Plane(z=0.2, tilt=np.pi / 2.0, azimuth=np.pi / 2.0), "2a"),
    ):
        np.testing.assert_allclose(plane.points(uv), experiment.case(case).points, atol=1e-12)


@pytest.mark.parametrize("form", FORMS)
@given(half=st.integers(10, 40), side=st.floats(0.05, 1.0))
def test_shapes_look_the_same_from_four_sides(form: str, half: int, side: float) -> None:
    _, proportions = made(Shape(form=form, side=side, pitch=side / (2 * half)))
    image = proportions.reshape(2 * half + 1, -1)
    for turned in (np.rot90(image), image[::-1], image.T):
        assert np.array_equal(image, turned)


def test_the_disc_has_the_samples_of_exact_arithmetic() -> None:
    _, proportions = made(Shape(form="disc"))
    steps = range(-20, 21)
    assert proportions.sum() == sum(i * i + j * j < 6 * 6 for i in steps for j in steps) == 109


@given(tilt=st.floats(-6.28, 6.28), azimuth=st.floats(-6.28, 6.28))
def test_a_planes_axes_are_square_and_v_is_raised_by_the_tilt(tilt: float, azimuth: float) -> None:
    axes = Plane(tilt=tilt, azimuth=azimuth).axes
    np.testing.assert_allclose(axes @ axes.T, np.eye(2), atol=1e-12)
    assert axes[0, 2] == 0.0
    assert axes[1, 2] == pytest.approx(np.sin(tilt), abs=1e-12)


def test_points_of_a_circle_and_of_a_grid() -> None:
    uv, proportions = made(Circle(radius=0.04, count=6))
    np.testing.assert_allclose(np.hypot(*uv.T), 0.04)
    np.testing.assert_allclose(np.linalg.norm(np.roll(uv, 1, axis=0) - uv, axis=1), 0.04)
    assert (proportions == 1.0).all()
    uv, _ = made(PointGrid(columns=3, rows=2, pitch=0.01))
    assert sorted(map(tuple, uv.round(6).tolist())) == [
        (x, y) for x in (-0.01, 0.0, 0.01) for y in (-0.005, 0.005)
    ]
    assert np.array_equal(made(Focus())[0], [[0.0, 0.0]])


def test_a_capital_letter_is_as_high_as_asked_and_stands_upright() -> None:
    uv, _ = made(Letters(text="T", height=0.07, dots=8))
    assert np.ptp(uv[:, 1]) == pytest.approx(0.07)
    pitch = 0.01
    top = uv[uv[:, 1] > 0.035 - 1e-9]
    below = uv[uv[:, 1] < 0.0]
    assert len(top) >= 5  # its bar, above its stem
    assert np.ptp(below[:, 0]) <= pitch
    np.testing.assert_allclose(uv.max(axis=0) + uv.min(axis=0), 0.0, atol=1e-12)


def test_letters_are_in_order_from_left_to_right() -> None:
    stem, both = made(Letters(text="I"))[0], made(Letters(text="IL"))[0]
    assert len(both) > len(stem)
    left = both[both[:, 0] < both[:, 0].min() + 1e-9]
    assert len(left) == len(stem)


def test_random_points_follow_from_their_generator() -> None:
    pattern = RandomPoints(count=50, side=0.1, low=0.4)
    (a, s), (b, _), (c, _) = made(pattern), made(pattern), made(pattern, 1)
    assert np.array_equal(a, b)
    assert not np.array_equal(a, c)
    assert (np.abs(a) <= 0.05).all()
    assert ((s >= 0.4) & (s <= 1.0)).all()


def test_points_of_ones_own() -> None:
    uv, share = made(Points(points=((0.0, 0.0), (0.01, 0.02)), proportions=(1.0, 0.5)))
    assert uv.tolist() == [[0.0, 0.0], [0.01, 0.02]]
    assert share.tolist() == [1.0, 0.5]


@pytest.mark.parametrize(
    ("make", "says"),
    [
        (lambda: Circle(radius=0.0, count=3), "radius"),
        (lambda: Circle(radius=0.1, count=0), "count"),
        (lambda: Letters(text=" "), "characters"),
        (lambda: Letters(text="a\nb"), "characters"),
        (lambda: Letters(text="a", dots=3), "dots"),
        (lambda: Letters(text="A漢字"), "has '漢', which Pillow"),
        (lambda: Shape(form="star"), "ring, disc"),
        (lambda: RandomPoints(count=3, low=0.0), "low"),
        (lambda: Points(points=()), "points"),
        (lambda: Points(points=((0.0, float("inf")),)), "points"),
        (lambda: Points(points=((0.0, 0.0),), proportions=(1.0, 2.0)), "proportions"),
        (lambda: Points(points=((0.0, 0.0),), proportions=(-1.0,)), "proportions"),
        (lambda: Points(points=((0.0, 0.0),), proportions=(0.0,)), "is silent"),
        (lambda: made(PointGrid(columns=200, rows=200, pitch=0.001)), "more than"),
        (lambda: made(Shape(form="ring", pitch=0.001)), "more than"),
        (lambda: Plane(z=11.0), "z"),
        (lambda: Plane(tilt=()), "nothing"),
    ],
)  # fmt: skip
def test_what_cannot_be_is_refused(make: object, says: str) -> None:
    with pytest.raises(pc.ArgumentError, match=says):
        make()  # type: ignore[operator]
