"""From samples to rows of gains, evaluated by the field of each row."""

from __future__ import annotations

import itertools
import math
from collections import Counter
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from msgspec.structs import replace

import pacinian as pc
from pacinian.rendering import sample_solver as module
from pacinian.rendering.envelope_gains import MAX_PAST
from pacinian.rendering.frame_cycle import Cycle
from pacinian.rendering.modulator import Modulator
from pacinian.rendering.sample_solver import SampleSolver
from pacinian.rendering.smoothing import Smoothing
from pacinian.scene.hands.hand import Hand
from pacinian.scene.modulation.presentation import present
from pacinian.scene.modulation.technique import AM, LM, STM
from pacinian.scene.modulation.waves import Pulse
from pacinian.scene.shapes.curves import Circle, Line

bounded = settings(max_examples=25)
levels = st.floats(0.0, 1.0)
ARRAY = pc.autd()
AIR = pc.Air()
TICK = 1e-3  # [s]
FULL = pc.Limits()
LEFT, MIDDLE, RIGHT = (-0.03, 0.0, 0.15), (0.0, 0.03, 0.15), (0.03, 0.0, 0.15)


class Loop:
    """A sampler without ramps, and a modulator, by default without smoothing. rows: per tick."""

    def __init__(self, scene: Any, rows: int = 2, rate: float | None = None) -> None:
        self.scene = scene if callable(scene) else lambda t: scene
        self.gap = TICK / rows
        self.times = np.arange(rows) * self.gap
        self.sampler, self.ticks = pc.Sampler(), 0
        self.skipped: Counter[str] = Counter()
        self.session = pc.Session(ARRAY)
        self.solver = SampleSolver(self.session, self.times, Cycle(self.session), self.skipped)
        self.modulator = Modulator(self.times, self.gap, Smoothing(rate=rate), len(ARRAY))

    def tick(self, limits: pc.Limits = FULL) -> Any:
        """Return the rows of gains of the next tick, (K, N)."""
        t = self.ticks * TICK
        samples = self.sampler.sample(self.scene(t), t)
        self.played = self.solver.solve(samples, t, limits, self.session.solver, 60.0)
        self.ticks += 1
        return self.modulator.make_rows(self.played, t).copy()

    def run(self, ticks: int, limits: pc.Limits = FULL) -> tuple[Any, Any]:
        """Return times of rows (R,) [s] and their gains (R, N)."""
        t = (np.arange(self.ticks, self.ticks + ticks)[:, None] * TICK + self.times).ravel()
        return t, np.concatenate([self.tick(limits) for _ in range(ticks)])


def pressures(rows: Any, points: Any) -> Any:
    """Return the radiation pressure of each row at each point, (R, M) [Pa]."""
    return pc.radiation_pressure(rows @ pc.matrix(ARRAY, points, AIR).T, AIR)


def point(position: Any, pressure: float = 4.0, **options: Any) -> pc.Point:
    return pc.Point(position=position, radiation_pressure=pressure, **options)


WAVES = {
    "constant": pc.Constant(0.6),
    "sine": pc.Sine(frequency=170.0),
    "square": pc.Square(frequency=90.0),
    "pulse": Pulse(0.003, period=0.011, rise=0.001),
    "trembling": "trembling",
}


@pytest.mark.parametrize(("one", "other"), list(itertools.combinations(WAVES, 2)))
def test_each_object_follows_its_own_envelope_row_by_row(one: str, other: str) -> None:
    items = point(LEFT, envelope=WAVES[one]), point(RIGHT, 3.0, envelope=WAVES[other])
    loop = Loop(pc.Scene(items))
    t, rows = loop.run(30)
    expected = np.column_stack([x.pressure * x.envelope.at(t) for x in items])
    np.testing.assert_allclose(pressures(rows, [LEFT, RIGHT]), expected, atol=0.08)
    assert loop.skipped["solve, nothing moved"] == 29


@bounded
@given(levels, levels, levels)
def test_any_strengths_come_out_as_asked(a: float, b: float, c: float) -> None:
    given_, where = (a, b, c), (LEFT, MIDDLE, RIGHT)
    items = [point(q, envelope=pc.Constant(s)) for q, s in zip(where, given_, strict=True)]
    P = pressures(Loop(pc.Scene(tuple(items))).tick(), where)
    np.testing.assert_allclose(P[0], 4.0 * np.array(given_), atol=0.1)


def test_at_full_strength_all_is_as_it_was_solved_and_at_none_silent() -> None:
    envelope = pc.Square(frequency=100.0, low=0.0, high=1.0)  # 5 ms on, 5 ms off
    other = Pulse(0.005, period=0.01)
    loop = Loop(pc.Scene((point(LEFT, envelope=envelope), point(RIGHT, envelope=other))))
    t, rows = loop.run(20)
    strength = envelope.at(t)
    np.testing.assert_allclose(strength, other.at(t), atol=1e-12)
    on, off = strength > 1.0 - 1e-9, strength < 1e-9
    assert len(loop.played.rows) == 1
    assert loop.played.rows[0].contributions is not None
    solved = loop.played.rows[0].gains
    np.testing.assert_allclose(rows[on], np.broadcast_to(solved, rows[on].shape), atol=1e-6)
    assert not np.abs(rows[off]).max() > 1e-4
    assert on.sum() == off.sum() == 16


def test_one_envelope_for_all_scales_the_gains_by_its_root() -> None:
    wave = pc.Sine(frequency=130.0)
    loop = Loop(pc.Scene((point(LEFT, envelope=wave), point(RIGHT, envelope=wave))))
    t, rows = loop.run(20)
    expected = np.sqrt(wave.at(t))[:, None] * loop.played.rows[0].gains
    np.testing.assert_allclose(rows, expected, atol=1e-6)
    assert loop.skipped["solve, nothing moved"] == 19


@pytest.mark.parametrize("rows", [1, 2, 4])
@pytest.mark.parametrize(
    "technique",
    [
        STM(frequency=100.0, along=Circle(0.015)),
        STM(frequency=50.0, along=Line(0.02), dwell=0.002),
        LM(frequency=50.0, amplitude=0.004),
    ],
)
def test_a_moving_focus_is_where_its_technique_says_in_each_row(technique: Any, rows: int) -> None:
    item = point((0.0, 0.0, 0.15), 4.0, technique=technique)
    loop = Loop(pc.Scene((item,)), rows, rate=750.0)
    t, played = loop.run(25)
    whole = pc.Sampler().sample(pc.Scene((item,)))
    for now, row in zip(t.tolist(), played, strict=True):
        focus = present(technique, whole, now, item.pose.matrix).positions
        assert pressures(row[None], focus)[0] == pytest.approx([4.0], rel=0.02)


def test_a_strong_focus_that_jumps_is_not_held_back_at_any_rate_of_the_device() -> None:
    loud = point((0.0, 0.0, 0.15), 60.0, technique=STM(frequency=250.0, along=Circle(0.03)))
    whole = pc.Sampler().sample(pc.Scene((loud,)))
    for rows in (1, 4):
        t, played = Loop(pc.Scene((loud,)), rows, rate=750.0).run(8)
        step = np.abs(np.diff(played, axis=0)).max()
        assert step > 750.0 * TICK / rows  # other objects would be slowed down
        for now, row in zip(t.tolist(), played, strict=True):
            focus = present(loud.technique, whole, now).positions
            assert pressures(row[None], focus)[0] == pytest.approx([60.0], rel=0.05)


def test_the_steps_of_a_modulation_are_solved_once_and_equal_fresh_solves() -> None:
    scene = pc.Scene(
        (point((0.0, 0.0, 0.15), technique=STM(frequency=100.0, along=Circle(0.015))),)
    )
    loop = Loop(scene)
    _, first = loop.run(10)  # one period
    assert len(loop.solver._steps) == 20
    solved = loop.session.propagator.work.solved
    _, second = loop.run(30)
    assert loop.session.propagator.work.solved == solved
    assert not loop.solver.fresh
    assert loop.skipped["solve, step of a modulation known"] == 60
    inner = (np.tile(first, (3, 1)) * second.conj()).sum(axis=1)  # apart from a common phase
    np.testing.assert_allclose(np.abs(inner), (np.abs(second) ** 2).sum(axis=1), rtol=1e-4)
    for k in (0, 7, 13):  # each step equals a first solve
        other = Loop(scene)
        other.ticks = k // 2
        np.testing.assert_allclose(np.abs(other.tick()[k % 2]), np.abs(first[k]), atol=1e-5)


def test_amplitude_modulation_comes_on_top_of_the_envelope() -> None:
    am, wave = AM(frequency=200.0), pc.Constant(0.5)
    loop = Loop(pc.Scene((point(LEFT, technique=am, envelope=wave), point(RIGHT))), 4)
    t, rows = loop.run(10)
    expected = np.column_stack([2.0 * am.factor(t), np.full(len(t), 4.0)])
    np.testing.assert_allclose(pressures(rows, [LEFT, RIGHT]), expected, atol=0.08)
    assert loop.session.propagator.work.solved == 1


def test_one_object_runs_round_while_another_stays_and_trembles() -> None:
    wave = pc.Sine(frequency=100.0)
    runs = point((0.0, 0.0, 0.15), technique=STM(frequency=50.0, along=Circle(0.02)))
    stays = point((0.05, 0.05, 0.15), envelope=wave)
    t, rows = Loop(pc.Scene((runs, stays))).run(20)
    whole = pc.Sampler().sample(pc.Scene((runs,)))
    for now, row in zip(t.tolist(), rows, strict=True):
        focus = present(runs.technique, whole, now).positions[0]
        expected = [4.0, 4.0 * float(wave.at(np.array([now]))[0])]
        np.testing.assert_allclose(
            pressures(row[None], [focus, stays.position])[0], expected, atol=0.12
        )


def test_two_modulations_of_one_rhythm_are_known_after_one_period() -> None:
    items = [
        point((x, 0.0, 0.15), technique=STM(frequency=f, along=Circle(0.01)))
        for x, f in ((-0.04, 100.0), (0.04, 50.0))
    ]
    loop = Loop(pc.Scene(tuple(items)))
    loop.run(20)
    solved = loop.session.propagator.work.solved
    loop.run(20)
    assert loop.session.propagator.work.solved == solved <= 40


def test_the_steps_that_are_kept_have_a_limit(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "CACHE_BYTES", 5 * 3 * ARRAY.positions.shape[0] * 8)
    runs = point((0.0, 0.0, 0.15), technique=STM(frequency=25.0, along=Circle(0.02)))
    loop = Loop(pc.Scene((runs, point(RIGHT, envelope=pc.Sine(frequency=30.0)))))
    for _ in range(20):
        loop.tick()
        assert sum(one.nbytes for one in loop.solver._steps.values()) <= module.CACHE_BYTES


QUIET = [[0.0, -0.05, 0.12], [0.0, -0.06, 0.12]]


@pytest.mark.parametrize(
    "limits",
    [pc.Limits(power=0.4), pc.Limits(quiet=(QUIET, 5.0)), pc.Limits(power=0.4, quiet=(QUIET, 5.0))],
)
def test_limits_that_join_all_gains_are_kept_in_every_row(limits: pc.Limits) -> None:
    items = (
        point(LEFT, envelope=pc.Sine(frequency=40.0)),
        point(RIGHT, envelope=pc.Square(frequency=30.0)),
        point(MIDDLE, 2.0),
    )
    _, rows = Loop(pc.Scene(items), rate=750.0).run(40, limits)
    power = (np.abs(rows) ** 2).sum(axis=1)
    assert power.max() > 0.05
    if limits.power is not None:
        assert power.max() <= limits.power * (1.0 + 1e-6)
    if limits.quiet is not None:
        p = np.abs(rows @ pc.matrix(ARRAY, QUIET, AIR).T)
        assert p.max() <= 5.0 * 1.01
        _, without = Loop(pc.Scene(items)).run(40)
        assert (
            np.abs(without @ pc.matrix(ARRAY, QUIET, AIR).T).max() > 15.0
        )  # the zone has an effect


@pytest.mark.parametrize(
    "limits", [pc.Limits(gain=0.02), pc.Limits(power=0.1), pc.Limits(quiet=(QUIET, 2.0))]
)
def test_new_limits_hold_from_the_first_row_on(limits: pc.Limits) -> None:
    loop = Loop(pc.Scene((point(LEFT, 40.0), point(RIGHT, 40.0))), 4, rate=100.0)
    loop.run(20)
    rows = loop.tick(limits)
    g = np.abs(rows)
    assert g.max() <= (limits.gain or 1.0) * (1.0 + 1e-5)
    assert (g * g).sum(axis=1).max() <= (limits.power or math.inf) * (1.0 + 1e-5)
    if limits.quiet is not None:
        assert np.abs(rows @ pc.matrix(ARRAY, QUIET, AIR).T).max() <= 2.0 * 1.01
    after = np.concatenate([rows[-1:], loop.tick(FULL), loop.tick(FULL)])
    loop.scene = silent
    fading = np.concatenate([after[-1:], loop.tick(FULL)])
    assert np.abs(np.diff(fading, axis=0)).max() <= 100.0 * loop.gap * (
        1.0 + 1e-4
    )  # the rate limit holds


def test_limits_that_join_all_gains_still_follow_the_mean_of_each_envelope() -> None:
    wave = pc.Sine(frequency=40.0)
    loop = Loop(pc.Scene((point(LEFT, envelope=wave), point(RIGHT))), 4)
    t, rows = loop.run(25, pc.Limits(power=100.0))
    means = wave.at(t).reshape(25, 4).mean(axis=1)
    expected = np.column_stack([4.0 * means, np.full(25, 4.0)])
    np.testing.assert_allclose(pressures(rows[::4], [LEFT, RIGHT]), expected, atol=0.12)
    assert not loop.modulator.steady


def test_limits_that_join_all_gains_need_no_solve_where_nothing_changes() -> None:
    items = point(LEFT, envelope=pc.Constant(0.5)), point(RIGHT)
    loop = Loop(pc.Scene(items))
    limits = pc.Limits(power=100.0)
    loop.run(1, limits)
    assert len(loop.solver.fresh) == 1
    loop.run(3, limits)
    assert not loop.solver.fresh
    assert loop.modulator.steady


def silent(t: float) -> pc.Scene:
    return NOTHING


def still(t: float) -> pc.Scene:
    return STILL


def flicker(t: float) -> pc.Scene:
    return STILL if round(t / TICK) % 7 < 4 else NOTHING


def leaps(t: float) -> pc.Scene:
    return pc.Scene((point(LEFT if round(t / TICK) % 6 < 3 else RIGHT, 80.0),))


STILL, NOTHING = pc.Scene((point(LEFT, 80.0), point(RIGHT, 20.0))), pc.Scene()


@pytest.mark.parametrize("scene", [still, flicker, leaps])
@pytest.mark.parametrize("rows", [1, 3])
def test_no_gain_changes_faster_than_its_rate(scene: Any, rows: int) -> None:
    rate = 200.0
    _, played = Loop(scene, rows, rate).run(30)
    before = np.concatenate([np.zeros((1, len(ARRAY))), played[:-1]])
    assert np.abs(played - before).max() <= rate * TICK / rows * (1.0 + 1e-5)
    assert np.abs(played).max() > 0.3


def test_different_envelopes_that_stand_still_change_no_faster_either() -> None:
    items = point(LEFT, 40.0, envelope=pc.Constant(0.9)), point(RIGHT, 40.0)
    rate = 100.0
    loop = Loop(lambda t: pc.Scene(items if t < 0.02 else items[:1]), 2, rate)
    _, played = loop.run(20)
    assert loop.played.rows[0].contributions is not None
    change = np.abs(np.diff(played, axis=0)).max()
    assert change <= rate * TICK / 2 * 1.05
    P = pressures(played[-1:], [LEFT, RIGHT])[0]
    np.testing.assert_allclose(P, [36.0, 40.0], rtol=0.05)


@pytest.mark.parametrize("others", [(), (0.3,), (None,)], ids=["alone", "beside", "crossing"])
@pytest.mark.parametrize("wait", [1, 2, 20])
def test_changed_envelopes_of_still_objects_change_no_faster_either(
    others: tuple[float | None, ...], wait: int
) -> None:
    def show(level: float) -> pc.Scene:
        levels = (level, *(1.01 - level if other is None else other for other in others))
        pairs = zip((LEFT, RIGHT), levels, strict=False)
        return pc.Scene(tuple(point(q, 40.0, envelope=pc.Constant(one)) for q, one in pairs))

    rate = 250.0
    loop = Loop(show(1.0), 2, rate)
    played = [loop.run(20)[1]]
    for level in 0.01, 0.5, 0.02, 0.9, 0.04, 1.0:  # also while the last change goes on
        now = show(level)
        loop.scene = lambda t, now=now: now
        played.append(loop.run(wait)[1])
    rows = np.concatenate(played)
    change = np.abs(np.diff(rows, axis=0)).max() / np.abs(rows).max()
    assert change <= rate * TICK / 2 * 1.5  # two objects may change at the same time


def test_what_goes_while_its_envelope_changes_falls_steadily() -> None:
    loop = Loop(pc.Scene((point(LEFT, 40.0, envelope=pc.Constant(0.01)),)), 4, 100.0)
    loop.run(20)
    loop.scene = lambda t: pc.Scene((point(LEFT, 40.0),))
    first = loop.tick()
    loop.scene = lambda t: NOTHING
    rows = np.concatenate([first[-1:], loop.run(80)[1]])
    P = pressures(rows, [LEFT])[:, 0]
    assert (np.diff(P) <= 1e-3).all(), "no gain swells, or turns, on the way to silence"
    assert P[0] > 0.0
    assert P[-1] == 0.0
    assert loop.modulator.steady


@pytest.mark.parametrize("level", [0.02, 0.1])
def test_a_cycle_that_goes_keeps_its_envelope(level: float) -> None:
    x, y, _ = ARRAY.centre
    disc = pc.Surface(
        shape=pc.Disc(0.015), pose=pc.Pose((x, y, 0.2)), radiation_pressure=60.0, envelope=pc.Constant(level)
    )  # fmt: skip
    loop = Loop(pc.Scene((disc,)), 4, 250.0)
    loop.solver.cycle.most = 2
    loop.run(20)
    assert len(loop.played.rows) == 2
    before = loop.tick()
    loop.scene = lambda t: NOTHING
    _, rows = loop.run(20)
    P = [pressures(some, [(x, y, 0.2), (x + 0.005, y, 0.2)]).max() for some in (before, rows)]
    assert P[1] <= P[0] + 1e-3
    assert loop.modulator.steady


def test_what_stays_keeps_its_pressure_when_limits_no_longer_join_it_to_others() -> None:
    stays = point(LEFT, 40.0, envelope=pc.Constant(0.1))
    other = point(RIGHT, 40.0, envelope=pc.Constant(0.11))
    limits = pc.Limits(power=100.0)
    loop = Loop(pc.Scene((stays, other)), 4, 250.0)
    loop.run(20, limits)
    loop.scene = lambda t: pc.Scene((stays,))
    _, rows = loop.run(20, limits)
    np.testing.assert_allclose(pressures(rows, [LEFT]), 4.0, atol=0.2)


def test_envelopes_that_change_in_every_tick_cost_no_more_and_more() -> None:
    loop = Loop(NOTHING, 2, 1.0)  # a fade takes a second
    for k in range(40):
        now = pc.Scene((point(LEFT, 40.0, envelope=pc.Constant(0.5 + 0.01 * k)),))
        loop.scene = lambda t, now=now: now
        loop.tick()
    assert len(loop.modulator._fade._past) <= MAX_PAST


def test_what_is_silenced_by_its_envelope_stays_silent_while_it_goes() -> None:
    loop = Loop(pc.Scene((point(LEFT, 40.0, envelope=pc.Constant(0.0)),)), 2, 250.0)
    loop.run(20)
    for scene in NOTHING, pc.Scene((point(RIGHT, 40.0),)):
        loop.scene = lambda t, scene=scene: scene
        _, rows = loop.run(20)
        assert pressures(rows, [LEFT]).max() < 0.5
        assert loop.modulator.steady


def test_groups_of_different_strengths_come_up_from_silence() -> None:
    items = point(LEFT, 80.0), point(RIGHT, 80.0, envelope=pc.Constant(0.01))
    rate = 100.0
    _, played = Loop(pc.Scene(items), 2, rate).run(20)
    before = np.concatenate([np.zeros((1, len(ARRAY))), played[:-1]])
    assert np.abs(played - before).max() <= rate * TICK / 2 * 1.05
    np.testing.assert_allclose(pressures(played[-1:], [LEFT, RIGHT])[0], [80.0, 0.8], atol=2.0)


def test_rows_are_steady_only_once_all_of_them_are_the_same() -> None:
    loop = Loop(STILL, 2, rate=250.0)
    seen = []
    for _ in range(12):
        rows = loop.tick()
        same = bool((rows == rows[0]).all())
        assert same or not loop.modulator.steady
        seen.append(loop.modulator.steady)
    assert seen[-1]
    assert not seen[0]


@pytest.mark.parametrize(
    ("scene", "steady"),
    [
        (STILL, True),
        (NOTHING, True),
        (pc.Scene((point(LEFT, envelope=pc.Constant(0.3)), point(RIGHT))), True),
        (pc.Scene((point(LEFT, envelope=pc.Sine(frequency=5.0)),)), False),
        (pc.Scene((point(LEFT), point(RIGHT, envelope=pc.Sine(frequency=5.0)))), False),
        (pc.Scene((point(LEFT), point(RIGHT, envelope=pc.Square(frequency=5.0)))), False),
        (pc.Scene((point(LEFT, technique=AM()),)), False),
        (pc.Scene((point(LEFT, technique=STM(frequency=5.0, along=Circle(0.01))),)), False),
    ],
)
@pytest.mark.parametrize("limits", [FULL, pc.Limits(power=50.0)])
@pytest.mark.parametrize("rows", [1, 2])
def test_what_never_changes_becomes_steady(
    scene: pc.Scene, steady: bool, limits: pc.Limits, rows: int
) -> None:
    loop = Loop(scene, rows)
    loop.run(4, limits)
    assert loop.modulator.steady is steady


def test_a_change_of_samples_limits_or_solver_is_solved_anew_and_nothing_else() -> None:
    loop = Loop(STILL)
    loop.run(2)
    assert not loop.solver.fresh
    limits = pc.Limits(power=1.0)
    loop.tick(limits)
    assert len(loop.solver.fresh) == 1
    loop.session.solver = "gs-pat"  # type: ignore[assignment]
    loop.tick(limits)
    assert loop.solver.fresh[0].solution.solver == "gs-pat"
    loop.scene = lambda t: pc.Scene(STILL.objects)
    loop.tick(limits)
    assert len(loop.solver.fresh) == 1
    loop.tick(limits)
    assert not loop.modulator.steady or len(loop.solver.fresh) == 0


def test_what_cannot_be_reached_is_left_out_and_counted() -> None:
    on = point(ARRAY.positions[5].tolist())
    far = point((0.0, 0.0, 12.0))
    loop = Loop(pc.Scene((on, far, point(LEFT))))
    loop.sampler = pc.Sampler()  # a sampler without an array leaves nothing out
    rows = loop.tick()
    assert len(loop.played.rows[0].samples) == 1
    assert (
        loop.skipped["samples on a transducer"]
        == loop.skipped["samples too far from the array"]
        == 1
    )
    assert pressures(rows, [LEFT])[0, 0] == pytest.approx(4.0, rel=0.02)


def test_on_a_hand_each_envelope_is_followed_too() -> None:
    hand = Hand.open("right", pc.Pose((0.0, 0.0, 0.16)))
    wave = pc.Sine(frequency=100.0)
    ball = pc.Volume(shape=pc.Sphere(0.008), radiation_pressure=4.0)
    left, right = (replace(ball, pose=pc.Pose((x, 0.0, 0.146))) for x in (-0.02, 0.02))
    balls = replace(left, envelope=wave), right
    loop = Loop(pc.Scene(balls, hands=(hand,)))
    t, rows = loop.run(10)
    solved = loop.played.rows[0]
    assert solved.groups is not None
    index = solved.groups.index
    assert set(index.tolist()) == {0, 1}
    B = loop.session.propagator.B  # weighted by facing and occlusion
    P = pc.radiation_pressure(rows @ B.T, AIR)
    full = pc.radiation_pressure(np.asarray(solved.solution.sound_pressure), AIR)
    expected = np.where(index == 0, wave.at(t)[:, None], 1.0) * full
    np.testing.assert_allclose(P, expected, atol=0.05 * full.max())


def test_what_is_well_seen_is_asked_for_in_full_however_far_another_hand_is() -> None:
    near, far = (Hand.open("right", pc.Pose((0.0, 0.0, z)), name=f"{z}") for z in (0.1, 0.9))
    balls = [
        pc.Volume(shape=pc.Sphere(0.008), radiation_pressure=0.5, pose=pc.Pose((0.0, 0.0, z)))
        for z in (0.086, 0.886)
    ]
    loop = Loop(pc.Scene(tuple(balls), hands=(near, far)))
    loop.tick()
    samples = loop.played.rows[0].samples
    assert np.ptp(samples.positions[:, 2]) > 0.7
    asked = pc.radiation_pressure(loop.played.rows[0].solution.targets.amplitudes, AIR)
    seen = samples.normals[:, 2] < -0.9
    np.testing.assert_allclose(asked[seen], samples.radiation_pressure[seen], rtol=1e-6)
