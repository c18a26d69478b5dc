"""Steering: the field of one object in free air moves with it, without another solve."""

from __future__ import annotations

import dataclasses
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from msgspec.structs import replace

import pacinian as pc
from pacinian.rendering.field_steering import (
    MAX_JUMP,
    MIN_STANDSTILL,
    Motion,
    Steering,
    find_factors,
)
from pacinian.rendering.frame_cycle import Cycle
from pacinian.rendering.steered_solver import (
    LIMITED_FROM,
    MAX_LATE_SHIFT,
    MAX_LIMITED_SHIFT,
    MAX_SHIFT,
    STEERED_TIME_FACTOR,
    SteeredSolver,
)
from pacinian.rendering.weak_samples import count_weak_samples
from pacinian.testing import ManualClock

from .manual_background import solve_beside

AIR, ARRAY, PERIOD = pc.Air(), pc.autd(), 1e-3
CENTRE = np.array([*ARRAY.centre[:2], 0.15])
BALL = pc.Volume(
    name="ball", shape=pc.Sphere(0.01), pose=pc.Pose(tuple(CENTRE)), radiation_pressure=0.5
)
NEAR = 4e-4
steps = st.tuples(*3 * [st.floats(-0.02, 0.02)])


def moved(d: Any, **changed: Any) -> pc.Volume:
    """Return the ball, moved by d [m]."""
    return replace(BALL, pose=pc.Pose(tuple(CENTRE + d)), **changed)


@given(steps, st.sampled_from([0.0, 1.0]))
def test_each_transducer_makes_at_the_new_place_what_it_made_at_the_old_one(
    d: Any, power: float
) -> None:
    air = pc.Air(attenuation="spherical" if power else "none")
    place = CENTRE + np.array(d)
    factors = find_factors(ARRAY, air, CENTRE, place)
    before = np.linalg.norm(ARRAY.positions - CENTRE, axis=1)
    after = np.linalg.norm(ARRAY.positions - place, axis=1)
    k = air.wavenumber(ARRAY.transducer.frequency)
    expected = np.exp(1j * k * (after - before)) * (after / before) ** power
    np.testing.assert_allclose(factors, expected, atol=3e-4)


def test_a_step_to_a_transducer_is_limited() -> None:
    factors = find_factors(ARRAY, AIR, CENTRE, ARRAY.positions[0])
    assert np.isfinite(factors).all()
    assert np.abs(factors).min() >= 0.499
    assert np.abs(factors).max() <= 2.001


def rows(count: int) -> Any:
    return np.ones((count, len(ARRAY)), np.complex64)


def motion(d: Any, t: float, velocity: float = 0.0, centre: Any = CENTRE) -> Motion:
    return Motion(centre, np.array(d, float), np.array([velocity, 0.0, 0.0]), t)


def test_rows_go_evenly_to_where_the_samples_are() -> None:
    steering = Steering(ARRAY, AIR)
    assert steering.settled
    assert steering.follow(motion((0.0, 0.0, 0.0), 0.0), 0.0, 4) is None
    steering.steer(rows(1), 0.0)
    assert steering.follow(motion((0.004, 0.0, 0.0), 0.0), 0.0, 4) is None
    for step in (0.001, 0.002, 0.003, 0.004):
        made = rows(1)
        steering.steer(made, 0.0)
        goal = find_factors(ARRAY, AIR, CENTRE, CENTRE + np.array([step, 0.0, 0.0]))
        np.testing.assert_allclose(made[0], goal, atol=1e-3)
    assert steering.settled


def test_rows_go_on_as_the_samples_moved_but_not_for_long() -> None:
    steering = Steering(ARRAY, AIR)
    steering.follow(motion((0.0, 0.0, 0.0), 0.0, 0.1), 0.0, 1)
    assert not steering.settled
    for t, x in ((0.01, 0.001), (0.03, 0.003), (5.0, 0.003)):
        made = rows(1)
        steering.steer(made, t)
        goal = find_factors(ARRAY, AIR, CENTRE, CENTRE + np.array([x, 0.0, 0.0]))
        np.testing.assert_allclose(made[0], goal, atol=1e-3)


def test_the_rows_of_a_tick_go_evenly_from_that_of_the_last_one() -> None:
    steering = Steering(ARRAY, AIR)
    steering.follow(motion((0.0, 0.0, 0.0), 0.0), 0.0, 1)
    steering.steer(rows(4), 0.0)
    steering.follow(motion((4e-4, 0.0, 0.0), 0.001), 0.001, 1)
    made = rows(4)
    steering.steer(made, 0.001)
    for row, x in zip(made, (1e-4, 2e-4, 3e-4, 4e-4), strict=True):
        goal = find_factors(ARRAY, AIR, CENTRE, CENTRE + np.array([x, 0.0, 0.0]))
        np.testing.assert_allclose(row, goal, atol=5e-3)


@pytest.mark.parametrize("goes", ["on", "far", "away"])
def test_a_change_of_the_solution_keeps_the_field(goes: str) -> None:
    """Whatever the next solution is, the gains times the factors make the field where it was."""
    steering = Steering(ARRAY, AIR)
    steering.follow(motion((0.003, 0.0, 0.0), 0.0), 0.0, 1)
    before = rows(1)
    steering.steer(before, 0.0)
    steering.steer(before := rows(1), 0.0)
    shift = {"on": 0.005, "far": 2.0 * MAX_JUMP, "away": 0.0}[goes]
    after = (
        None
        if goes == "away"
        else motion((0, 0, 0), 0.0, centre=CENTRE + np.array([shift, 0.0, 0.0]))
    )
    factors = steering.follow(after, 0.0, 8)
    assert factors is not None
    made = rows(1) * factors
    steering.steer(made, 0.0)
    if goes == "away":
        np.testing.assert_allclose(made, before, atol=1e-3)
    else:  # a part of the way has passed
        assert np.abs(np.angle(made / before)).max() < 0.5


class Solved(SimpleNamespace):
    """What `SteeredSolver` reads of a solution."""

    def __replace__(self, **changed: Any) -> Solved:
        return Solved(**{**self.__dict__, **changed})


class Row(SimpleNamespace):
    """A row of a solution, equal to itself only."""

    __eq__ = object.__eq__
    __hash__ = object.__hash__


class Solving:
    """A solver whose solves take as long, and come as near, as the test says."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        def copy(solved: Solved, **changed: Any) -> Solved:
            return solved.__replace__(**changed)

        monkeypatch.setattr("pacinian.rendering.steered_solver.replace", copy)
        self.steered, self.sampler = SteeredSolver(ARRAY), pc.Sampler()
        self.sampler.prepare(ARRAY, AIR)
        self.late, self.error, self.saturation, self.due = False, 0.01, 0.0, True
        self.solved: list[Any] = []
        self.factors: list[float] = []
        self.moves: list[Any] = []

    def solve(self, samples: Any, factor: float) -> Any:
        self.factors.append(factor)
        if self.solved and self.solved[-1].samples is samples and not self.late:
            return self.solved[-1]
        solution = SimpleNamespace(error=self.error, saturation=self.saturation)
        row = Row(solution=solution, ran_out_of_time=self.late)
        self.solved.append(Solved(samples=samples, rows=(row,), motion=None))
        return self.solved[-1]

    def at(self, d: Any, t: float) -> Any:
        samples = self.sampler.sample(pc.Scene((moved(d),)), t)
        return self.steered.solve(
            samples, t, self.solve, lambda _: self.due, lambda a, b: self.moves.append(b - a)
        )


@pytest.fixture
def solving(monkeypatch: pytest.MonkeyPatch) -> Solving:
    return Solving(monkeypatch)


def test_there_is_no_other_solve_until_the_samples_have_moved_far(solving: Solving) -> None:
    first = solving.at((0.0, 0.0, 0.0), 0.0)
    second = solving.at((0.001, 0.001, 0.0), 0.01)
    assert second.rows == first.rows
    assert second.motion.shift == pytest.approx([0.001, 0.001, 0.0])
    assert len(solving.solved) == 1
    third = solving.at((0.004, 0.0, 0.0), 0.02)
    assert third.rows != first.rows
    assert not third.motion.shift.any()
    assert solving.moves == [pytest.approx([0.004, 0.0, 0.0])]


@pytest.mark.parametrize("late", [False, True])  # as a solution at the limit often is
def test_at_the_limit_samples_move_further_until_the_next_solve(
    solving: Solving, late: bool
) -> None:
    solving.late, solving.due, solving.saturation = late, False, LIMITED_FROM
    first = solving.at((0.0, 0.0, 0.0), 0.0)
    assert solving.at((0.9 * MAX_LIMITED_SHIFT * 0.15, 0.0, 0.0), 0.01).motion.shift[0] > 0.0
    assert len({id(one.samples) for one in solving.solved}) == 1
    third = solving.at((1.1 * MAX_LIMITED_SHIFT * 0.15, 0.0, 0.0), 0.02)
    assert third.rows != first.rows


def test_towards_the_array_half_the_way_counts(solving: Solving) -> None:
    first = solving.at((0.0, 0.0, 0.0), 0.0)
    assert solving.at((0.0, 0.0, 0.0014), 0.01).rows == first.rows
    assert solving.at((0.0, 0.0, -0.0014), 0.02).rows == first.rows
    assert solving.at((0.0, 0.0, 0.0017), 0.03).rows != first.rows


def test_samples_that_stand_are_solved_for_where_they_are(solving: Solving) -> None:
    first = solving.at((0.0, 0.0, 0.0), 0.0)
    assert solving.at((0.001, 0.0, 0.0), 0.01).rows == first.rows
    assert solving.at((0.001, 0.0, 0.0), 0.02).rows == first.rows
    at_rest = solving.at((0.001, 0.0, 0.0), 0.011 + MIN_STANDSTILL)
    assert at_rest.rows != first.rows
    assert not at_rest.motion.shift.any()
    assert solving.at((0.001, 0.0, 0.0), 0.3).rows == at_rest.rows


def test_samples_that_tremble_stand(solving: Solving) -> None:
    first = solving.at((0.0, 0.0, 0.0), 0.0)
    for n in range(1, 20):
        made = solving.at((0.002 + 1e-4 * (-1) ** n, 0.0, 0.0), 0.01 * n)
        assert (made.rows == first.rows) == (n < 5)
    assert len(solving.solved) == 2


def test_samples_that_creep_are_not_solved_for_again_and_again(solving: Solving) -> None:
    for n in range(300):
        solving.at((5e-6 * n, 0.0, 0.0), 0.01 * n)
    assert len(solving.solved) <= 5


def test_a_movement_goes_on_only_if_there_were_two_steps(solving: Solving) -> None:
    def speed(x: float, t: float) -> float:
        return float(solving.at((x, 0.0, 0.0), t).motion.velocity[0])

    assert speed(0.0, 0.0) == 0.0
    assert speed(0.001, 0.01) == 0.0
    assert speed(0.002, 0.02) == pytest.approx(0.1)
    assert speed(0.0025, 0.03) == pytest.approx(0.05)
    assert speed(0.0028, 0.031) == pytest.approx(0.05), "too soon to tell"
    assert speed(0.0015, 0.04) == 0.0
    assert speed(0.0005, 0.05) == pytest.approx(-0.1)
    assert speed(0.0, 0.01) == 0.0, "time has jumped back"


def test_what_has_not_changed_is_the_same_object(solving: Solving) -> None:
    scene = pc.Scene((BALL,))
    samples = solving.sampler.sample(scene)
    made = [
        solving.steered.solve(samples, t, solving.solve, lambda _: True, lambda *_: None)
        for t in (0.0, 0.01, 0.02)
    ]
    assert made[1] is made[2]


def test_a_solution_is_steered_until_the_next_one_is_as_near_to_its_targets(
    solving: Solving,
) -> None:
    first = solving.at((0.0, 0.0, 0.0), 0.0)
    solving.late, solving.error = True, 0.5
    for n in range(1, 5):
        played = solving.at((0.004 * n, 0.0, 0.0), 0.01 * n)
        assert played.rows == first.rows
        assert played.motion.shift == pytest.approx([0.004 * n, 0.0, 0.0])
    assert len({id(one.samples) for one in solving.solved}) == 2  # it goes on where it began
    assert solving.factors[1:] == 4 * [STEERED_TIME_FACTOR]
    solving.error = 0.005
    played = solving.at((0.02, 0.0, 0.0), 0.05)
    assert played.rows != first.rows
    assert played.motion.shift == pytest.approx([0.016, 0.0, 0.0])


def test_what_is_steered_too_far_gives_way_to_what_there_is(solving: Solving) -> None:
    first = solving.at((0.0, 0.0, 0.0), 0.0)
    solving.late, solving.error = True, 0.5
    solving.at((0.004, 0.0, 0.0), 0.01)
    far = solving.at((1.1 * MAX_LATE_SHIFT * 0.15, 0.0, 0.0), 0.02)
    assert far.rows != first.rows


@pytest.mark.parametrize("due", [True, False])
def test_a_late_solve_that_helps_no_more_does_not_hold_up_the_next(
    solving: Solving, due: bool
) -> None:
    solving.late, solving.due = True, due
    solving.at((0.0, 0.0, 0.0), 0.0)
    solving.at((1.1 * MAX_SHIFT * 0.15, 0.0, 0.0), 0.01)
    assert (len({id(one.samples) for one in solving.solved}) == 1) == due


def test_near_the_array_nothing_is_steered(solving: Solving) -> None:
    low = (0.0, 0.0, 0.03 - CENTRE[2])
    assert solving.at(low, 0.0) is None
    assert not solving.solved


def test_other_samples_are_solved_for(solving: Solving) -> None:
    first = solving.at((0.0, 0.0, 0.0), 0.0)
    samples = solving.sampler.sample(pc.Scene((moved((0, 0, 0), radiation_pressure=0.6),)), 0.01)
    again = solving.steered.solve(samples, 0.01, solving.solve, lambda _: True, lambda *_: None)
    assert again.rows != first.rows


AROUND = np.random.default_rng(0).standard_normal(
    (200, 3)
)  # places of the ball's surface that have no samples
AROUND *= 0.01 / np.linalg.norm(AROUND, axis=1)[:, None]


def place(t: float, v: float) -> Any:
    """Return where a ball is that swings along x, [m]."""
    return CENTRE + np.array([0.01 * np.sin(v * t / 0.01), 0.0, 0.0])


def felt(v: float, ticks: int) -> tuple[Any, Any, pc.Renderer]:
    """Move the ball in a loop; return force and rms error at other places of its surface, relative to what is asked."""

    def scene(t: float) -> pc.Scene:
        seen = np.floor(t * 90.0) / 90.0
        return pc.Scene((replace(BALL, pose=pc.Pose(tuple(place(seen, v)))),))

    force, off = [], []
    clock = ManualClock()
    with pc.Renderer(ARRAY, scene, clock=clock) as renderer:
        solve_beside(renderer, 2)
        for k in range(ticks):
            t = k * PERIOD
            renderer.tick(t)
            clock.time = t + PERIOD
            if k > 60 and k % 7 == 0:
                g = renderer.last_frame.gains(renderer.backend.capability)[-1]
                p = pc.field(ARRAY, g, place(t, v) + AROUND, AIR)
                P = pc.radiation_pressure(p, AIR) / BALL.radiation_pressure
                force.append(P.mean())
                off.append(np.sqrt(((P - 1.0) ** 2).mean()))
    return np.array(force), np.array(off), renderer


@pytest.mark.parametrize("v", [0.02, 0.1])
def test_a_moving_ball_presses_as_asked_with_few_solves(v: float) -> None:
    force, off, renderer = felt(v, 300)
    assert np.abs(force - 1.0).max() < 0.06
    assert np.median(off) < 0.05
    assert off.max() < 0.12
    assert renderer.report.solves < 60
    # what is measured is the steered field, where the object is
    assert renderer.report.compute_felt()["ball"].rms < 0.1


def test_a_still_scene_is_played_as_it_is() -> None:
    clock = ManualClock()
    with pc.Renderer(ARRAY, pc.Scene((BALL,)), clock=clock) as renderer:
        solve_beside(renderer, 2)
        for k in range(200):
            renderer.tick(k * PERIOD)
            clock.time = (k + 1) * PERIOD
        assert renderer.report.skipped["drive, nothing changed"] > 100


def test_with_a_hand_another_object_or_limits_for_all_gains_nothing_is_steered() -> None:
    hand = pc.Hand.open("right", pc.Pose(tuple(CENTRE + np.array((0.0, 0.0, 0.1)))))
    other = replace(BALL, name="other", pose=pc.Pose(tuple(CENTRE + np.array((0.04, 0.0, 0.0)))))
    zone = pc.Zone(tuple(CENTRE + np.array((0.1, 0.0, 0.0))), radius=0.01, pressure=5.0)
    for scene, limits in (
        (pc.Scene((BALL,), hands=(hand,)), None),
        (pc.Scene((BALL, other)), None),
        (pc.Scene((BALL,)), pc.Limits(gain=1.0, zones=(zone,))),
        (pc.Scene((BALL,)), pc.Limits(power=100.0)),
    ):
        with pc.Renderer(ARRAY, scene, clock=ManualClock(), limits=limits) as renderer:
            solve_beside(renderer, 2)
            for k in range(20):
                renderer.tick(k * PERIOD)
            assert renderer._pipeline.played.solutions.motion is None


@pytest.mark.parametrize("steered", [True, False])
def test_only_what_is_steered_is_tried_again_with_two_frames(
    steered: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Other scenes would play frames that run out of time."""
    tried = list[float]()
    monkeypatch.setattr(Cycle, "try_again", lambda self, solved, t: tried.append(t))
    other = replace(BALL, name="other", pose=pc.Pose(tuple(CENTRE + np.array((0.04, 0.0, 0.0)))))
    scene = pc.Scene((BALL,) if steered else (BALL, other))
    with pc.Renderer(ARRAY, scene, clock=ManualClock()) as renderer:
        solve_beside(renderer, 2)
        for k in range(20):
            renderer.tick(k * PERIOD)
    assert bool(tried) == steered


def test_the_field_stays_with_the_ball_when_it_is_steered_no_more() -> None:
    """Another ball appears; the gains that are played then take over the factors."""
    clock = ManualClock()
    other = replace(BALL, name="other", pose=pc.Pose(tuple(CENTRE + np.array((0.0, 0.06, 0.0)))))
    force = []

    def scene(t: float) -> pc.Scene:
        ball = replace(BALL, pose=pc.Pose(tuple(place(t, 0.05))))
        return pc.Scene((ball, other) if t > 0.2 else (ball,))

    with pc.Renderer(ARRAY, scene, clock=clock) as renderer:
        solve_beside(renderer, 2)
        for k in range(260):
            t = k * PERIOD
            renderer.tick(t)
            clock.time = t + PERIOD
            steered = renderer._pipeline.played.solutions.motion is not None
            if 10 < k < 195 or k > 215:
                assert steered == (k < 200)
            if k > 150:
                g = renderer.last_frame.gains(renderer.backend.capability)[-1]
                P = pc.radiation_pressure(pc.field(ARRAY, g, place(t, 0.05) + AROUND, AIR), AIR)
                force.append(P.mean() / BALL.radiation_pressure)
    assert min(force) > 0.85
    assert max(force) < 1.15


def test_a_ball_that_rolls_has_samples_that_move_as_one() -> None:
    sampler = pc.Sampler()
    sampler.prepare(ARRAY, AIR)
    before = sampler.sample(pc.Scene((BALL,)), 0.0)
    rolled = replace(
        BALL, pose=pc.Pose(tuple(CENTRE + np.array((0.002, 0.0, 0.0)))).rotate("y", 0.3)
    )
    after = sampler.sample(pc.Scene((rolled,)), 0.01)
    assert after.find_shift(before, 1e-9) == pytest.approx([0.002, 0.0, 0.0])


def test_what_is_weak_in_two_frames_is_told_from_where_they_were_solved_for() -> None:
    """Their mean counts. While the field is steered, their samples are elsewhere."""
    ball = replace(BALL, shape=pc.Sphere(0.03), radiation_pressure=8.0)  # beyond the array's limit

    def scene(t: float) -> pc.Scene:
        x = 2e-4 * max(0, round(t / PERIOD) - 40)
        return pc.Scene((replace(ball, pose=pc.Pose(tuple(CENTRE + np.array([x, 0.0, 0.025])))),))

    compared = 0
    with pc.Renderer(ARRAY, scene, clock=ManualClock(), max_cycle_frames=2) as renderer:
        solve_beside(renderer, 2)
        for k in range(60):
            renderer.tick(k * PERIOD)
            played = renderer.played
            if played.motion is not None and played.motion.shift.any():
                assert played.solved_samples is not played.samples
                if played.cycle and all(
                    one.all_samples is played.solved_samples for one in played.rows
                ):
                    there = dataclasses.replace(
                        played, samples=played.solved_samples, before_motion=None
                    )
                    assert count_weak_samples(played, ()) == count_weak_samples(there, ())
                    compared += 1
    assert compared
