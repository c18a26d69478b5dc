from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import msgspec
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import pacinian as pc
from pacinian.scene.shapes.arc_length import Polyline3D
from pacinian.scene.shapes.curves import Circle, Curve, Line, Lissajous, Polyline

if TYPE_CHECKING:
    from pacinian.types import Floats

bounded = settings(max_examples=60)
sizes = st.floats(1e-3, 0.5)
turns = st.integers(1, 6)
places = st.tuples(*[st.floats(-0.2, 0.2)] * 3)


@st.composite
def polylines(draw: st.DrawFn) -> Polyline:
    points = draw(st.lists(places, min_size=2, max_size=8))
    points = [*points, tuple(x + draw(st.floats(0.01, 0.1)) for x in points[-1])]
    return Polyline(tuple(points), closed=draw(st.booleans()))


curves = st.one_of(
    sizes.map(Line),
    sizes.map(Circle),
    st.builds(Lissajous, sizes, sizes, turns, turns, st.floats(-6.28, 6.28)),
    polylines(),
)
each = pytest.mark.parametrize(
    "curve",
    [
        Line(0.06),
        Circle(0.02),
        Lissajous(0.06, 0.04),
        Lissajous(0.04, 0.05, 3, 2, 0.5),
        Lissajous(0.05, 0.05, 1, 1, 0.0),
        Polyline(((0.0, 0.0, 0.0), (0.03, 0.0, 0.01), (0.03, 0.05, -0.02))),
        Polyline(((0.0, 0.0, 0.0), (0.03, 0.0, 0.01), (0.03, 0.05, -0.02)), closed=True),
    ],
    ids=lambda c: type(c).__name__,
)


def dense(curve: Any, K: int = 20_001) -> Floats:
    return curve.at(np.linspace(0.0, 1.0, K))


def nearest(curve: Any, points: Floats) -> Floats:
    """Return the distance to many points of the curve."""
    on = dense(curve, 4001)
    return np.sqrt(((points[:, None] - on) ** 2).sum(axis=2)).min(axis=1)


# ----------------------------------------------------------------------------- along them


@given(curve=curves)
@bounded
def test_the_speed_is_constant(curve: Any) -> None:
    """The length of the path up to u is proportional to u."""
    u = np.linspace(0.0, 1.0, 5001)
    steps = np.sqrt((np.diff(curve.at(u), axis=0) ** 2).sum(axis=1))
    arc = np.concatenate([[0.0], np.cumsum(steps)])
    assert np.abs(arc / arc[-1] - u).max() < 3e-3  # chords cut corners
    assert steps.max() <= arc[-1] / 5000 * 1.05


@given(curve=curves)
@bounded
def test_a_curve_is_closed_and_repeats(curve: Any) -> None:
    u = np.array([0.0, 0.1, 0.37, 0.9])
    assert curve.at(u + 1.0) == pytest.approx(curve.at(u), abs=1e-9)
    assert curve.at(u - 3.0) == pytest.approx(curve.at(u), abs=1e-9)
    ends = curve.at(np.array([0.0, 1.0, 1.0 - 1e-9, -1e-20]))
    assert np.ptp(ends, axis=0) == pytest.approx(np.zeros(3), abs=1e-7)


@given(curve=curves)
@bounded
def test_the_length_is_that_of_the_path(curve: Any) -> None:
    path = np.sqrt((np.diff(dense(curve), axis=0) ** 2).sum(axis=1)).sum()
    back = isinstance(curve, Line) or (isinstance(curve, Polyline) and not curve.closed)
    assert path / (2.0 if back else 1.0) == pytest.approx(curve.length, rel=2e-3)


@given(curve=curves)
@bounded
def test_the_reach_holds_all_of_it(curve: Any) -> None:
    farthest = np.sqrt((dense(curve, 2001) ** 2).sum(axis=1).max())
    assert farthest <= curve.bounding_radius * (1 + 1e-9)
    if not isinstance(curve, Lissajous):
        assert farthest == pytest.approx(curve.bounding_radius, rel=1e-2)


def test_an_open_curve_goes_there_and_back() -> None:
    u = np.array([0.0, 0.25, 0.5, 0.75, 1.0])
    assert Line(0.04).at(u)[:, 0] == pytest.approx([-0.02, 0.0, 0.02, 0.0, -0.02])
    path = Polyline(((0.0, 0.0, 0.0), (0.0, 0.02, 0.0), (0.01, 0.02, 0.0)))
    expected = [[0, 0, 0], [0, 0.015, 0], [0.01, 0.02, 0], [0, 0.015, 0], [0, 0, 0]]
    assert path.at(u) == pytest.approx(np.array(expected))


def test_a_circle_turns_from_x_to_y() -> None:
    points = Circle(0.02).at(np.array([0.0, 0.25, 0.5]))
    assert points == pytest.approx(np.array([[0.02, 0, 0], [0, 0.02, 0], [-0.02, 0, 0]]))


@given(
    width=sizes, height=sizes, a=turns, b=turns, phase=st.floats(0, 2 * math.pi), u=st.floats(0, 1)
)
@bounded
def test_a_lissajous_figure_is_on_its_formula(
    width: float, height: float, a: int, b: int, phase: float, u: float
) -> None:
    figure = Lissajous(width, height, a, b, phase)
    divisor = math.gcd(a, b)
    assert (figure.a, figure.b) == (a // divisor, b // divisor)
    x, y, z = figure.at(np.array([u]))[0]
    assert z == 0.0
    # all s that give y; one of them must give x
    turn = np.arange(figure.b)
    s = np.arcsin(np.clip(2 * y / height, -1.0, 1.0))
    s = np.concatenate([s + 2 * np.pi * turn, np.pi - s + 2 * np.pi * turn]) / figure.b
    made = width / 2 * np.sin(figure.a * s + phase)
    assert np.abs(made - x).min() < 1e-6


# --------------------------------------------------------------------------------- cover


@given(curve=curves, spacing=st.floats(2e-3, 0.02))
@bounded
def test_a_cover_is_on_the_curve_at_even_steps(curve: Any, spacing: float) -> None:
    points, normals, area = curve.sample_surface(spacing)
    assert len(points) == max(1, math.floor(curve.length / spacing + 1e-9))
    assert curve.distance(points).max() <= 1e-4 * curve.bounding_radius
    assert not normals.any()
    piece = curve.length / len(points)
    assert np.ptp(area) == 0.0
    assert area[0] == pytest.approx(piece**2)
    chords = np.sqrt((np.diff(points, axis=0) ** 2).sum(axis=1))
    assert (chords <= piece * 1.01).all()
    if isinstance(curve, Line):
        assert chords == pytest.approx(np.full(len(chords), piece))
        assert points.mean(axis=0) == pytest.approx(np.zeros(3), abs=1e-12)


@each
def test_too_many_samples_are_refused_before_memory_is(curve: Any) -> None:
    with pytest.raises(pc.ArgumentError, match=r"spacing.*samples.*larger"):
        curve.sample_surface(1e-12)


# ------------------------------------------------------------------------------- distance


@given(curve=curves, seed=st.integers(0, 1000))
@bounded
def test_the_distance_is_that_of_the_nearest_point(curve: Any, seed: int) -> None:
    points = np.random.default_rng(seed).uniform(-0.4, 0.4, (20, 3))
    d = curve.distance(points)
    step = (2.0 if isinstance(curve, Polyline) else 1.0) * curve.length / 4000
    slack = 1e-4 * curve.bounding_radius + 1e-9
    assert (d <= nearest(curve, points) + slack).all()
    assert (d >= nearest(curve, points) - step - slack).all()


@each
def test_distances_and_places_leave_their_argument_alone(curve: Any) -> None:
    points, u = np.random.default_rng(0).uniform(-0.1, 0.1, (5, 3)), np.linspace(0, 2, 5)
    before = points.copy(), u.copy()
    curve.distance(points)
    curve.distance(np.asfortranarray(points))
    curve.at(u)
    assert (points == before[0]).all()
    assert (u == before[1]).all()
    assert curve.distance(np.empty((0, 3))).shape == (0,)


# ----------------------------------------------------------------------------- degenerate


def test_points_that_repeat_change_nothing() -> None:
    a, b, c = (0.0, 0.0, 0.0), (0.03, 0.0, 0.01), (0.03, 0.05, -0.02)
    u = np.linspace(0.0, 1.0, 101)
    for closed in (False, True):
        once, twice = Polyline((a, b, c), closed), Polyline((a, a, b, b, b, c, c), closed)
        assert twice.length == pytest.approx(once.length)
        assert twice.at(u) == pytest.approx(once.at(u))
        assert twice.distance(once.at(u)) == pytest.approx(np.zeros(101), abs=1e-9)


@given(points=st.lists(places, min_size=1, max_size=6), copies=st.integers(2, 3))
@bounded
def test_pieces_of_any_points_are_finite(points: Any, copies: int) -> None:
    given_as = np.repeat(np.array(points) * 1e-150, copies, axis=0)
    pieces = Polyline3D(given_as)
    assert np.isfinite(pieces.at(pieces.length * np.linspace(0.0, 1.0, 7))).all()


ONE, FAR_AWAY = (0.0, 0.0, 0.0), (60.0, 0.0, 0.0)


@pytest.mark.parametrize(
    ("argument", "make"),
    [
        ("length", lambda: Line(0.0)),
        ("radius", lambda: Circle(20.0)),
        ("width", lambda: Lissajous(0.0, 0.1)),
        ("height", lambda: Lissajous(0.1, math.nan)),
        ("a", lambda: Lissajous(0.1, 0.1, a=0, b=1)),
        ("b", lambda: Lissajous(0.1, 0.1, a=1, b=101)),
        ("points", lambda: Polyline(())),
        ("points", lambda: Polyline((ONE,))),
        ("points", lambda: Polyline((ONE, ONE))),
        ("points", lambda: Polyline((ONE, (math.nan, 0.0, 0.0)))),
        ("points", lambda: Polyline((ONE, FAR_AWAY))),
        ("points", lambda: Polyline((ONE, (1e300, 0.0, 0.0)))),
        ("points", lambda: Polyline(((0.0, 0.0), (0.1, 0.0)))),  # type: ignore[arg-type]
        ("points", lambda: Polyline(np.zeros((1_000_000, 3)))),  # type: ignore[arg-type]
    ],
)
def test_a_curve_that_cannot_be_is_refused_by_name(argument: str, make: Any) -> None:
    with pytest.raises(pc.ArgumentError, match=f"^`{argument}` "):
        make()


def test_many_points_will_do() -> None:
    s = np.linspace(0.0, 20 * np.pi, 100_000)
    helix = Polyline(np.stack([0.02 * np.cos(s), 0.02 * np.sin(s), 1e-4 * s], axis=-1))  # type: ignore[arg-type]
    assert helix.length == pytest.approx(20 * np.pi * math.hypot(0.02, 1e-4), rel=1e-6)
    points = helix.at(np.array([0.0, 0.2, 0.3]))
    assert helix.distance(points) == pytest.approx(np.zeros(3), abs=1e-9)


@each
def test_curves_cannot_be_changed_and_come_back_from_a_file(curve: Any) -> None:
    for name in curve.__struct_fields__:
        with pytest.raises(AttributeError):
            setattr(curve, name, 0.01)
    assert msgspec.json.decode(msgspec.json.encode(curve), type=Curve) == curve
