from __future__ import annotations

import math
from dataclasses import replace
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import msgspec
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation

import pacinian as pc
from pacinian.scene.modulation import presentation
from pacinian.scene.modulation.presentation import present
from pacinian.scene.modulation.technique import AM, LM, SIMULTANEOUS, STM, Simultaneous, Technique
from pacinian.scene.sampling.samples import Samples, no_samples
from pacinian.scene.shapes.curves import Circle, Line, Lissajous, Polyline

if TYPE_CHECKING:
    from pacinian.types import Floats

bounded = settings(max_examples=50)
seeds = st.integers(0, 10_000)
counts = st.integers(1, 24)
MOVING = [
    STM(100.0),
    STM(100.0, "outline"),
    STM(100.0, Circle(0.01)),
    STM(100.0, Lissajous(0.02, 0.01), dwell=0.001),
    LM(50.0, 0.002, 0.5),
]
each_moving = pytest.mark.parametrize("technique", MOVING, ids=str)
ROUTES = ["samples", "outline", Circle(0.01), Line(0.03), Lissajous(0.02, 0.03, 2, 3)]


def patch(M: int, seed: int = 0, flat: bool = False, item: int = 3) -> Samples:
    """Return samples of a bent patch of skin, 60 mm wide, facing roughly -z."""
    rng = np.random.default_rng(seed)
    x, y = rng.uniform(-0.03, 0.03, (2, M))
    bend = 0.0 if flat else 8.0
    normals = np.stack([-2 * bend * x, 0 * x, -np.ones(M)], axis=-1)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    return Samples(
        positions=np.stack([x, y, 0.2 - bend * x * x], axis=-1),
        radiation_pressure=rng.uniform(1.0, 5.0, M),
        normals=normals,
        area=rng.uniform(5e-5, 9e-5, M),
        objects=np.full(M, item),
        keys=rng.permutation(1000)[:M].astype(np.int64),
        most=np.full(M, 5.0),
        regions=np.full(M, -1),
    )


def path(technique: Any, samples: Samples, K: int = 720, frame: Any = None) -> list[Samples]:
    """Return the samples presented over a period."""
    t = (np.arange(K) + 0.5) / (K * technique.frequency)
    more = () if frame is None else (frame,)
    return [present(technique, samples, float(s), *more) for s in t]


def positions(shown: list[Samples]) -> Floats:
    return np.concatenate([s.positions for s in shown])


# ---------------------------------------------------------------------------------- still


@given(t=st.floats(-1e6, 1e6), M=counts)
@bounded
def test_still_techniques_give_the_very_samples(t: float, M: int) -> None:
    samples = patch(M)
    for technique in (Simultaneous(), AM(50.0, 0.5)):
        assert technique.keeps_places
        assert not technique.single
        assert technique.step(t) is None
        assert present(technique, samples, t) is samples


@given(frequency=st.floats(0.0, 1e5), depth=st.floats(0.0, 1.0), t=st.floats(-1e300, 1e300))
@bounded
def test_am_is_a_sine_from_its_lowest_1_less_its_depth(
    frequency: float, depth: float, t: float
) -> None:
    factor = AM(frequency, depth).factor(np.array([t]))[0]
    assert max(0.0, 1.0 - depth - 1e-12) <= factor <= 1.0
    phase = np.array([0.0, 0.25, 0.5, 0.75, 1.0])
    shape = 1.0 - depth * np.array([1.0, 0.5, 0.0, 0.5, 1.0])
    assert AM(200.0, depth).factor(phase / 200.0) == pytest.approx(shape)


@each_moving
def test_what_moves_does_not_change_in_strength(technique: Any) -> None:
    assert not technique.keeps_places
    assert (technique.factor(np.linspace(-1.0, 1.0, 9)) == 1.0).all()
    assert technique.single == isinstance(technique, STM)
    assert len(present(technique, no_samples(), 0.3)) == 0


# ------------------------------------------------------------------------------- schedule


@given(
    frequency=st.sampled_from([1, 7, 20, 50, 64, 70, 100, 125, 200, 333]),
    places=st.sampled_from([None, 1, 2, 3, 5, 10, 16, 20]),
    off=st.sampled_from([0.98, 1.0, 1.02]),
    rate=st.sampled_from([1000, 2000, 4000, 40_000]),
    begin=st.integers(-100_000, 10_000_000),
)
@bounded
def test_repeat_rate_and_dwell_are_those_of_exact_arithmetic(
    frequency: int, places: int | None, off: float, rate: int, begin: int
) -> None:
    """The reference is exact: at time t, the place is floor(n (f t mod 1)) of n."""
    # a dwell that does not divide the period is replaced by the nearest that does
    dwell = None if places is None else min(off / places, 1.0) / frequency
    technique = STM(float(frequency), dwell=dwell)
    n = technique.places
    assert n == (places or 720)
    for k in range(begin, begin + 100):
        t = Fraction(k, rate)
        exact = math.floor(n * ((frequency * t) % 1))
        assert technique.step(float(t)) == exact


@given(dwell=st.integers(1, 12), seed=seeds)
@bounded
def test_the_focus_stays_for_its_dwell_and_then_moves_on(dwell: int, seed: int) -> None:
    """At 2 kHz, each of 5 places per repeat lasts `dwell` frames."""
    technique = STM(2000.0 / (5 * dwell), Circle(0.01), dwell=dwell / 2000.0)
    samples = patch(9, seed)
    shown = [present(technique, samples, k / 2000.0) for k in range(10 * dwell)]
    for k, now in enumerate(shown):
        assert now is shown[k // dwell % 5 * dwell]
    assert len({id(now) for now in shown}) == 5


@each_moving
def test_steps_are_whole_and_within_bounds_at_any_time(technique: Any) -> None:
    for t in (-1e300, -1e6, -1e-20, -0.0, 0.0, 1e-300, 1e6, 1e300):
        step = technique.step(t)
        assert isinstance(step, int)
        assert -64 <= step < 720
        assert len(present(technique, patch(5), t)) == (1 if technique.single else 5)


@each_moving
@given(t=st.floats(-100.0, 100.0), periods=st.integers(-50, 50))
@bounded
def test_the_same_step_gives_the_same_samples(technique: Any, t: float, periods: int) -> None:
    samples = patch(7)
    again = t + periods / technique.frequency
    if technique.step(again) == technique.step(t):
        assert present(technique, samples, again) is present(technique, samples, t)


# ------------------------------------------------------------------------------------ STM


@given(M=counts, seed=seeds)
@bounded
def test_all_samples_are_visited_within_a_period_for_equal_times(M: int, seed: int) -> None:
    samples = patch(M, seed)
    shown = path(STM(100.0), samples)
    index = {tuple(q): m for m, q in enumerate(samples.positions.tolist())}
    visits = [index[tuple(now.positions[0].tolist())] for now in shown]
    times = np.bincount(visits, minlength=M)
    assert times.min() >= 720 // M
    assert times.max() <= -(-720 // M)
    assert (np.diff(visits) != 0).sum() == M - 1  # each is visited once
    assert visits[0] == samples.keys.argmin()
    for m, now in zip(visits, shown, strict=True):
        assert now.radiation_pressure[0] == samples.radiation_pressure[m]
        assert now.area[0] == samples.area[m]
        assert (now.normals[0] == samples.normals[m]).all()


def grid() -> Samples:
    """Return 6 by 6 samples, 8 mm apart, so that many distances are equal."""
    x, y = np.meshgrid(np.arange(6) * 0.008, np.arange(6) * 0.008)
    positions = np.stack([x.ravel(), y.ravel(), np.full(36, 0.2)], axis=-1)
    return replace(patch(36, flat=True), positions=positions, keys=np.arange(36, dtype=np.int64))


@pytest.mark.parametrize("along", ["samples", "outline"])
@given(seed=seeds)
@bounded
def test_rounding_does_not_change_the_route_round_a_grid(along: Any, seed: int) -> None:
    R = Rotation.random(rng=np.random.default_rng(seed)).as_matrix()
    moved = replace(grid(), positions=grid().positions @ R.T, normals=grid().normals @ R.T)
    was, now = (path(STM(100.0, along), s, 90, F) for s, F in ((grid(), np.eye(3)), (moved, R)))
    assert positions(now) == pytest.approx(positions(was) @ R.T, abs=1e-9)


def test_a_tour_is_short() -> None:
    """The tour is at most a quarter longer than a path through the rows of the grid and back."""
    samples = grid()
    steps = np.linalg.norm(np.diff(positions(path(STM(100.0), samples)), axis=0), axis=1)
    assert steps.sum() < 1.25 * 35 * 0.008


@given(M=counts, seed=seeds, along=st.sampled_from(ROUTES))
@bounded
def test_a_focus_is_one_sample_of_its_object_on_a_route_that_hardly_changes_with_the_pressures(
    M: int, seed: int, along: Any
) -> None:
    samples, technique = patch(M, seed), STM(100.0, along)
    p, rng = samples.radiation_pressure, np.random.default_rng(seed)
    shown = path(technique, samples, 90)
    for now in shown[::3]:
        assert len(now) == 1
        assert now.objects.tolist() == [3]
        assert now.keys.tolist() == [-4]
        assert now.keys.dtype == np.int64
        assert now.most.tolist() == [5.0]
        if along != "samples":
            assert now.radiation_pressure[0] == pytest.approx((p * p).sum() / p.sum())
        assert p.min() - 1e-12 <= now.radiation_pressure[0] <= p.max() + 1e-12
        assert np.linalg.norm(now.normals) == pytest.approx(1.0)
    after = positions(path(technique, samples.with_pressure(p * rng.uniform(0.999, 1.001, M)), 90))
    assert np.abs(after - positions(shown)).max() < (1e-12 if along == "samples" else 3e-4)


@pytest.mark.parametrize("along", ROUTES[2:], ids=str)
def test_samples_that_hardly_press_do_not_count_on_a_curve(along: Any) -> None:
    samples = patch(9)
    p = samples.radiation_pressure.copy()
    p[0] = 0.0
    with_it = positions(path(STM(100.0, along), samples.with_pressure(p), 30))
    without = positions(path(STM(100.0, along), samples.only(np.arange(1, 9)), 30))
    assert with_it == pytest.approx(without, abs=1e-12)


@given(M=counts, seed=seeds, along=st.sampled_from(ROUTES))
@bounded
def test_a_route_does_not_depend_on_the_order_of_the_samples(M: int, seed: int, along: Any) -> None:
    samples, technique = patch(M, seed), STM(100.0, along)
    other = samples.only(np.random.default_rng(seed).permutation(M))
    assert positions(path(technique, other, 90)) == pytest.approx(
        positions(path(technique, samples, 90)), abs=1e-9
    )


@given(M=counts, seed=seeds, along=st.sampled_from(ROUTES))
@bounded
def test_when_everything_is_turned_so_is_the_route(M: int, seed: int, along: Any) -> None:
    samples, technique = patch(M, seed), STM(100.0, along)
    R = Rotation.random(rng=np.random.default_rng(seed)).as_matrix()
    shift = np.array([0.1, -0.2, 0.3])
    moved = replace(
        samples, positions=samples.positions @ R.T + shift, normals=samples.normals @ R.T
    )
    was, now = path(technique, samples, 90, np.eye(3)), path(technique, moved, 90, R)
    assert positions(now) == pytest.approx(positions(was) @ R.T + shift, abs=1e-8)
    normals = np.concatenate([s.normals for s in was])
    assert np.concatenate([s.normals for s in now]) == pytest.approx(normals @ R.T, abs=1e-8)


@given(M=st.integers(3, 24), seed=seeds)
@bounded
def test_an_outline_is_the_convex_hull_at_constant_speed(M: int, seed: int) -> None:
    samples = patch(M, seed, flat=True)
    q = positions(path(STM(100.0, "outline"), samples))
    hull = ConvexHull(samples.positions[:, :2])
    off = hull.equations[:, :2] @ q[:, :2].T + hull.equations[:, 2:]
    assert np.abs(off.max(axis=0)).max() < 1e-9  # on the border: on one side, and outside none
    assert q[:, 2] == pytest.approx(np.full(720, 0.2))
    steps = np.linalg.norm(np.diff(q, axis=0, append=q[:1]), axis=1)
    assert (
        steps.max() <= hull.area / 720 + 1e-9
    )  # in two dimensions, SciPy's `area` is the perimeter
    assert steps.sum() == pytest.approx(hull.area, rel=0.02)
    # facing -z, anticlockwise is clockwise in x and y
    x, y = (q[:, :2] - q[:, :2].mean(axis=0)).T
    assert (x * np.roll(y, -1) - y * np.roll(x, -1)).sum() < 0.0


@given(M=st.integers(3, 24), seed=seeds)
@bounded
def test_an_outline_starts_towards_the_x_axis_and_turns_to_y(M: int, seed: int) -> None:
    samples = patch(M, seed, flat=True)
    samples = replace(samples, normals=-samples.normals)  # facing +z
    q = positions(path(STM(100.0, "outline"), samples))
    x, y, z = (q - q.mean(axis=0)).T
    assert x[0] > 0.0
    assert y[0] == pytest.approx(0.0, abs=3e-4)  # within the length of one place
    assert y[5] > y[0]
    assert np.abs(z).max() < 1e-12


@pytest.mark.parametrize("direction", [(1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 2, 3), (0, 0, 0)])
@pytest.mark.parametrize("facing", [True, False])
def test_samples_on_a_line_are_passed_there_and_back(direction: Any, facing: bool) -> None:
    d = np.array(direction) / max(1.0, float(np.linalg.norm(direction)))
    if facing and abs(d[2]) > 0.9:
        return  # skin is never like that
    for M in (1, 2, 8):
        samples, s = patch(M), np.linspace(0.0, 0.03, M)
        samples = replace(samples, positions=s[:, None] * d + [0.0, 0.0, 0.2])
        if not facing:
            samples = replace(samples, normals=np.zeros((M, 3)))
        q = positions(path(STM(100.0, "outline"), samples)) - [0.0, 0.0, 0.2]
        length = 0.03 if M > 1 and d.any() else 0.0
        assert np.linalg.norm(np.cross(q, d), axis=1).max() < 1e-9
        along = q @ d
        assert along.min() == pytest.approx(0.0, abs=1e-4)
        assert along.max() == pytest.approx(length, abs=1e-4)
        steps = np.abs(np.diff(along, append=along[:1]))
        assert steps.max() <= 2 * length / 720 + 1e-9


@given(M=counts, seed=seeds, along=st.sampled_from(ROUTES[2:]))
@bounded
def test_a_curve_lies_in_the_tangent_plane_about_the_centre(M: int, seed: int, along: Any) -> None:
    samples = patch(M, seed)
    w = samples.radiation_pressure / samples.radiation_pressure.sum()
    normal = w @ samples.normals
    normal /= np.linalg.norm(normal)
    shown = path(STM(100.0, along), samples)
    q = positions(shown) - w @ samples.positions
    assert np.abs(q @ normal).max() < 1e-12
    expected = along.at(np.arange(720) / 720.0)
    assert np.linalg.norm(q, axis=1) == pytest.approx(np.linalg.norm(expected, axis=1), abs=1e-9)
    assert q.mean(axis=0) == pytest.approx(np.zeros(3), abs=1e-3 * along.bounding_radius)
    assert all(now.normals[0] == pytest.approx(normal) for now in shown[::90])


def test_a_curve_s_x_axis_is_the_frame_s_in_the_plane() -> None:
    samples, technique = patch(9, flat=True), STM(100.0, Line(0.02))
    q = positions(path(technique, samples)) - present(technique, samples, 0.0025).positions
    assert np.abs(q[:, 0]).max() == pytest.approx(0.01, rel=1e-2)
    assert np.abs(q[:, 1:]).max() < 1e-12
    turned = Rotation.from_euler("z", 30, degrees=True).as_matrix()
    q = positions(path(technique, samples, frame=turned))
    x, y = np.ptp(q[:, :2], axis=0)
    assert math.degrees(math.atan2(y, x)) == pytest.approx(30.0)


@pytest.mark.parametrize("technique", MOVING, ids=str)
def test_without_pressure_or_normals_all_is_finite(technique: Any) -> None:
    samples = patch(9)
    still = replace(samples, radiation_pressure=np.zeros(9), normals=np.zeros((9, 3)))
    closed = replace(
        samples, normals=samples.normals * [[1], [-1], [1], [-1], [1], [-1], [0], [0], [0]]
    )
    for odd in (still, closed):
        for now in path(technique, odd, 30):
            assert np.isfinite(now.positions).all()
            assert np.isfinite(now.normals).all()
            assert np.isfinite(now.radiation_pressure).all()


def test_only_so_many_motions_are_kept() -> None:
    for seed in range(2 * presentation.MAX_CACHED):
        present(STM(100.0), patch(2, seed), 0.0)
    assert len(presentation._cache) <= presentation.MAX_CACHED


# ------------------------------------------------------------------------------------- LM


@given(
    M=counts,
    seed=seeds,
    angle=st.floats(-2.0 * math.pi, 2.0 * math.pi),
    frequency=st.floats(1.0, 500.0),
)
@bounded
def test_lm_moves_every_sample_to_and_fro_across_its_normal(
    M: int, seed: int, angle: float, frequency: float
) -> None:
    samples, technique = patch(M, seed), LM(frequency, 0.002, angle)
    t = (np.arange(200) + 0.5) / (200 * frequency)
    shown = [present(technique, samples, float(s)) for s in t]
    d = np.array([now.positions for now in shown]) - samples.positions
    assert np.abs(np.einsum("kmi,mi->km", d, samples.normals)).max() < 1e-12
    size = np.linalg.norm(d, axis=2)
    assert size.max() == pytest.approx(0.002, rel=1e-9)
    expected = np.abs(0.002 * np.sin(2 * np.pi * frequency * t))
    assert np.abs(size - expected[:, None]).max() <= 0.5 * 0.002 / 64 + 1e-9
    assert np.abs(d.mean(axis=0)).max() < 1e-6
    for now in shown[::50]:
        assert now.keys is samples.keys
        assert now.radiation_pressure is samples.radiation_pressure


@pytest.mark.parametrize("normal", [(0, 0, 1), (0, 0, -1), (0, 0, 0)])
@pytest.mark.parametrize("angle", [0.0, 0.5])
def test_lm_s_angle_is_from_the_frame_s_x_axis_about_the_normal(angle: float, normal: Any) -> None:
    samples = replace(patch(4), normals=np.tile(np.array(normal, dtype=float), (4, 1)))
    d = present(LM(50.0, 0.002, angle), samples, 0.005).positions - samples.positions
    side = -1.0 if normal[2] < 0 else 1.0
    expected = 0.002 * np.array([math.cos(angle), side * math.sin(angle), 0.0])
    assert d == pytest.approx(np.tile(expected, (4, 1)), abs=1e-12)


@given(M=counts, seed=seeds, angle=st.floats(-2.0 * math.pi, 2.0 * math.pi))
@bounded
def test_when_everything_is_turned_so_is_lm(M: int, seed: int, angle: float) -> None:
    samples, technique = patch(M, seed), LM(50.0, 0.002, angle)
    R = Rotation.random(rng=np.random.default_rng(seed)).as_matrix()
    moved = replace(samples, positions=samples.positions @ R.T, normals=samples.normals @ R.T)
    was = present(technique, samples, 0.003, np.eye(3)).positions
    assert present(technique, moved, 0.003, R).positions == pytest.approx(was @ R.T, abs=1e-9)


def test_lm_across_a_normal_along_x_uses_the_y_axis() -> None:
    samples = replace(patch(2), normals=np.array([[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0]]))
    d = present(LM(50.0, 0.002), samples, 0.005).positions - samples.positions
    assert d == pytest.approx(np.array([[0.0, 0.002, 0.0]] * 2), abs=1e-12)


# ----------------------------------------------------------------------------- arguments


@pytest.mark.parametrize(
    ("make", "argument"),
    [
        (lambda: AM(-1.0), "frequency"),
        (lambda: AM(10.0, 1.1), "depth"),
        (lambda: STM(0.0), "frequency"),
        (lambda: STM(math.inf), "frequency"),
        (lambda: STM(10.0, "outlin"), "along"),  # type: ignore[arg-type]
        (lambda: STM(10.0, np.zeros((3, 3))), "along"),  # type: ignore[arg-type]
        (lambda: STM(10.0, dwell=0.0), "dwell"),
        (lambda: STM(10.0, dwell=0.2), "dwell"),
        (lambda: STM(10.0, dwell=1e-6), "dwell"),
        (lambda: LM(-1.0, 0.001), "frequency"),
        (lambda: LM(10.0, 0.0), "amplitude"),
        (lambda: LM(10.0, 20.0), "amplitude"),
        (lambda: LM(10.0, 0.001, math.nan), "angle"),
    ],
)
def test_bad_arguments_are_refused_by_name(make: Any, argument: str) -> None:
    with pytest.raises(pc.ArgumentError, match=f"^`{argument}` "):
        make()


@pytest.mark.parametrize(
    "technique",
    [
        *MOVING,
        SIMULTANEOUS,
        AM(),
        STM(70.0, Polyline(((0.0, 0.0, 0.0), (0.01, 0.0, 0.0), (0.0, 0.01, 0.0)), closed=True)),
    ],
    ids=str,
)
def test_every_technique_comes_back_from_a_scene_file(technique: Any) -> None:
    assert msgspec.json.decode(msgspec.json.encode(technique), type=Technique) == technique
    for name in technique.__struct_fields__:
        with pytest.raises(AttributeError):
            setattr(technique, name, 0.1)


@pytest.mark.parametrize("text", ['{"type": "am", "x": 1}', '{"type": "sm"}', '{"frequency": 1}'])
def test_what_a_scene_file_cannot_mean_is_refused(text: str) -> None:
    with pytest.raises(msgspec.ValidationError):
        msgspec.json.decode(text, type=Technique)
