"""Solves in the background: frames are on time however long a solve takes, and nothing else changes."""

from __future__ import annotations

import gc
import subprocess
import sys
import threading
from collections import Counter
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from msgspec.structs import replace

import pacinian as pc
from pacinian.gallery import SCENES
from pacinian.rendering.background_schedule import REST_INTERVAL, BackgroundSchedule
from pacinian.rendering.background_solve import BackgroundSolve
from pacinian.rendering.emitted_measurement import Probe
from pacinian.rendering.measurement_schedule import TICKS_PER_MEASUREMENT
from pacinian.rendering.pipeline import WAIT_FOR_SOLVE_AFTER
from pacinian.rendering.rerender import rerender
from pacinian.rendering.scene_solver import SceneSolver
from pacinian.rendering.steered_solver import STEERED_TIME_FACTOR
from pacinian.scene.config_sections import DEFAULT_BUDGET
from pacinian.scene.modulation.technique import AM
from pacinian.scene.motion import Motion
from pacinian.testing import ManualClock
from pacinian_plugins.backends.simulated import Simulated
from pacinian_plugins.solvers.lagrange.solver import Lagrange

from .manual_background import ManualBackground, solve_beside

if TYPE_CHECKING:
    from pathlib import Path

ARRAY = pc.autd()
AIR = pc.Air()
TICK = 1e-3  # [s]
POINT = pc.Point(position=(0.0, 0.0, 0.15), radiation_pressure=5.0, name="point")


def at(x: float, **options: Any) -> pc.Scene:
    return pc.Scene((replace(POINT, position=(x, 0.0, 0.15), **options),))


def make(scene: Any, **options: Any) -> tuple[pc.Renderer, Simulated]:
    device = Simulated(rate=2000.0, keep=1000)
    options.setdefault("clock", ManualClock())
    return pc.Renderer(ARRAY, scene, backend=device, **options), device


def press(frame: Any, device: Simulated, points: Any) -> Any:
    """Return the radiation pressure of each row at each point, (K, M) [Pa]."""
    B = pc.matrix(ARRAY, points, AIR)
    return pc.radiation_pressure(frame.gains(device.capability) @ B.T, AIR)


def test_frames_go_on_while_a_solve_takes_its_time_and_follow_it_when_it_is_done() -> None:
    scene = [at(-0.01)]
    renderer, device = make(lambda t: scene[0])
    points = [[-0.01, 0.0, 0.15], [0.02, 0.0, 0.15]]
    with renderer:
        for k in range(10):
            renderer.tick(k * TICK)
        background = solve_beside(renderer)
        background.ready = False
        scene[0] = at(0.02)
        for k in range(10, 25):
            renderer.tick(k * TICK)
            assert press(renderer.last_frame, device, points)[-1] == pytest.approx(
                [5.0, 0.0], abs=0.3
            )
        assert background.started == 1
        assert renderer.rendered_scene.objects[0].pose.position[0] == -0.01
        background.ready = True
        for k in range(25, 45):
            renderer.tick(k * TICK)
        assert press(renderer.last_frame, device, points)[-1] == pytest.approx([0.0, 5.0], abs=0.3)
        assert renderer.rendered_scene is scene[0]
        report = renderer.report
        assert report.frames_sent == report.ticks == 45
        assert report.skipped["solve, still under way"] == 14
        assert not report.faults


def test_what_it_says_of_moving_samples_is_that_they_are_interpolated() -> None:
    renderer, _ = make(at)
    with renderer:
        renderer.tick(0.0)
        assert not renderer.report.deviations.totals
        solve_beside(renderer)
        for k in range(1, 30):
            renderer.tick(k * TICK)
        assert renderer.report.deviations.totals["point"]["interpolated"].ticks >= 28


class TakesTime(pc.Solver):
    """Like `lagrange`, but takes NEEDED [s] of a manual clock, or as long as it may. given: that time of each solve."""

    name = "takes time"
    keeps = pc.solver("lagrange").keeps
    NEEDED = 0.1

    def __init__(self, clock: ManualClock) -> None:
        self.clock, self.given = clock, list[float]()

    def solve(self, *problem: Any) -> Any:
        budget = problem[4]
        left = budget.due - budget.clock()
        self.given.append(left)
        self.clock.time += min(left, self.NEEDED)
        result = pc.solver("lagrange").solve(*problem)
        if left < self.NEEDED:
            problem[5][:] *= 0.3
        return result


@pytest.mark.parametrize("limits", [pc.Limits(power=50.0), pc.Limits()])
def test_a_slow_limit_gets_more_time_while_all_is_at_rest(limits: pc.Limits) -> None:
    """Otherwise, a still scene would stay as the first short solves have left it."""
    clock = ManualClock()
    solver, scene = TakesTime(clock), [at(0.0)]
    renderer, _ = make(lambda t: scene[0], solver=solver, limits=limits, clock=clock)
    with renderer:
        renderer.tick(0.0)
        solve_beside(renderer)
        solver.given.clear()
        for k in range(1, 1500):
            renderer.tick(k * TICK)
        if limits.power is None:
            assert max(solver.given) < 0.02
            return
        assert max(solver.given) >= solver.NEEDED
        assert renderer.solution is not None
        assert renderer.solution.status is pc.Status.ok
        scene[0] = at(0.01)  # what moves is solved for at once again
        solver.given.clear()
        for k in range(1500, 1520):
            renderer.tick(k * TICK)
        assert solver.given[0] < 0.02


def test_a_moving_focus_passes_evenly_from_one_solution_to_the_next() -> None:
    """The rows that were sent show it: the focus is never lost between two solutions."""
    renderer, device = make(lambda t: at(0.2 * t))
    with renderer:
        for k in range(10):
            renderer.tick(k * TICK)
        background = solve_beside(renderer, ticks=4)
        for k in range(10, 100):
            background.ready = k % 4 == 0
            renderer.tick(k * TICK)
            x = np.linspace(0.2 * (k - 12) * TICK, 0.2 * k * TICK, 25)
            points = np.column_stack([x, np.zeros(25), np.full(25, 0.15)])
            assert k < 20 or press(renderer.last_frame, device, points).max(axis=1).min() > 4.5


def test_what_moves_is_solved_for_where_it_will_be_when_frames_arrive_there() -> None:
    """The rows that were sent are evaluated where the point is at that time."""
    motion = Motion(velocity=(0.3, 0.0, 0.0), time=0.0)
    renderer, device = make(at(-0.02, motion=motion))
    with renderer:
        for k in range(10):
            renderer.tick(k * TICK)
        background = solve_beside(renderer, ticks=4)
        for k in range(10, 90):
            background.ready = k % 4 == 0
            renderer.tick(k * TICK)
            x = -0.02 + 0.3 * (k * TICK + TICK / 2)  # in the last row
            P = press(renderer.last_frame, device, [[x, 0.0, 0.15]])[-1, 0]
            assert k < 26 or pytest.approx(5.0, rel=0.1) == P


def test_a_still_scene_ends_as_it_does_in_ticks() -> None:
    heard = []
    disc = pc.Surface(shape=pc.Disc(0.01), pose=pc.Pose((0.0, 0.0, 0.15)), radiation_pressure=1.0)
    for beside in (False, True):
        renderer, _ = make(pc.Scene((disc, POINT)))
        with renderer:
            renderer.tick(0.0)
            if beside:
                solve_beside(renderer)
            for k in range(1, 60):
                renderer.tick(k * TICK)
            assert renderer.samples is not None
            heard.append(
                renderer.compute_pressures(renderer.samples.positions, renderer.played.facing)
            )
    np.testing.assert_allclose(heard[1], heard[0], atol=0.02 * heard[0].max())


@pytest.mark.parametrize("stage", ["sample", "solve"])
def test_an_error_in_a_solve_beside_the_ticks_silences_and_is_told_as_in_a_tick(stage: str) -> None:
    class Fails(pc.Solver):
        name = "fails"
        broken = False

        def solve(self, propagator: Any, targets: Any, *rest: Any) -> pc.Result:
            if self.broken:
                raise RuntimeError("in the middle")
            rest[-1][:] = 0.5
            return pc.Result()

    class Breaks(pc.Sampler):
        broken = False

        def sample(self, *args: Any) -> Any:
            if self.broken:
                raise RuntimeError("in the middle")
            return super().sample(*args)

    solver, sampler = Fails(), Breaks()
    renderer, device = make(at, solver=solver, sampler=sampler)
    with renderer:
        renderer.tick(0.0)
        renderer.schedule.in_background = True
        renderer.tick(TICK)
        (solver if stage == "solve" else sampler).broken = True
        for k in range(2, 200):
            renderer.clock.wait_until(k * TICK)
            renderer.tick(k * TICK)
            if renderer.halted is not None:
                break
        assert renderer.halted is not None
        assert renderer.halted.stage == stage
        assert "in the middle" in renderer.halted.message
        assert device.silent
        solver.broken = sampler.broken = False
        renderer.reset()
        for k in range(300, 330):
            renderer.clock.wait_until(k * TICK)
            renderer.tick(k * TICK)
        assert renderer.halted is None
        assert not device.silent


def test_new_limits_hold_from_the_first_row_on() -> None:
    renderer, device = make(at)
    with renderer:
        renderer.tick(0.0)
        background = solve_beside(renderer)
        background.ready = False
        for k in range(1, 9):
            renderer.tick(k * TICK)
        renderer.limits = pc.Limits(power=1e-4)
        for k in range(9, 12):
            renderer.tick(k * TICK)
            g = renderer.last_frame.gains(device.capability)
            assert (np.abs(g) ** 2).sum(axis=1).max() <= 1e-4 * 1.001
        renderer.session.solver = "gs-pat"
        renderer.tick(12 * TICK)
        assert renderer.solution is not None
        assert renderer.solution.solver == "gs-pat"


def test_a_region_at_rest_is_solved_once_without_a_deadline() -> None:
    disc = pc.Surface(
        name="disc", shape=pc.Disc(0.015), pose=pc.Pose((0.0, 0.0, 0.15)), radiation_pressure=1.0
    )
    moved = replace(disc, pose=pc.Pose((0.003, 0.0, 0.15)))
    scene = [pc.Scene((disc,))]
    renderer, _ = make(lambda t: scene[0])
    patient, _ = make(lambda t: scene[0], adaptive=False)
    with renderer, patient:
        patient.tick(0.0)
        patient.tick(50 * TICK)  # its ramp has ended
        renderer.tick(0.0)
        background = solve_beside(renderer)
        for k in range(1, 60):
            renderer.tick(k * TICK)
        assert patient.solution is not None
        hurried = renderer.solution
        assert hurried is not None
        assert hurried.error > 1.5 * patient.solution.error
        for k in range(60, 400):
            renderer.tick(k * TICK)
        assert renderer.solution is not None
        assert renderer.solution.error == pytest.approx(patient.solution.error, rel=0.1)
        solves = renderer.report.solves
        for k in range(400, 1000):
            renderer.tick(k * TICK)
        assert renderer.report.solves == solves
        scene[0] = pc.Scene((moved,))
        for k in range(1000, 1200):
            renderer.tick(k * TICK)
            if renderer._pipeline.deadline.unhurried:
                break
        background.ready, started = False, background.started
        for more in range(k + 1, k + 200):  # however long it takes, the ticks go on
            renderer.clock.wait_until(more * TICK)
            renderer.tick(more * TICK)
        assert background.started == started
        background.ready = True
        for more in range(k + 200, k + 400):
            renderer.tick(more * TICK)
        assert renderer.solution.error < 1.2 * patient.solution.error


@pytest.mark.parametrize("rested", [90, 400])
def test_what_begins_to_move_after_a_rest_has_a_deadline_at_once(rested: int) -> None:
    """Before the solve without a deadline, and after it."""
    disc = pc.Surface(
        name="disc", shape=pc.Disc(0.015), pose=pc.Pose((0.0, 0.0, 0.15)), radiation_pressure=1.0
    )
    scene = [pc.Scene((disc,))]
    renderer, _ = make(lambda t: scene[0])
    with renderer:
        renderer.tick(0.0)
        solve_beside(renderer)
        for k in range(1, rested):
            renderer.tick(k * TICK)
        assert renderer._pipeline.schedule.rests
        for k in range(rested, rested + 50):
            x = 1e-4 * (k - rested + 1)
            scene[0] = pc.Scene((replace(disc, pose=pc.Pose((x, 0.0, 0.15))),))
            renderer.tick(k * TICK)
            assert not renderer._pipeline.deadline.unhurried


class Listening(Lagrange):
    """Notes whether each solve without a deadline is cancelled."""

    def __init__(self) -> None:
        super().__init__()
        self.cancelled: list[bool] = []

    def solve(
        self, propagator: Any, targets: Any, limits: Any, warm: Any, budget: Any, g: Any
    ) -> Any:
        if budget.endless:
            self.cancelled.append(budget.spent)
        return super().solve(propagator, targets, limits, warm, budget, g)


@pytest.mark.parametrize("moves", [False, True])
def test_a_solve_without_a_deadline_ends_when_the_scene_changes(moves: bool) -> None:
    disc = pc.Surface(
        name="disc", shape=pc.Disc(0.015), pose=pc.Pose((0.0, 0.0, 0.15)), radiation_pressure=1.0
    )

    def begin() -> Any:
        scene, solver = [pc.Scene((disc,))], Listening()
        renderer, _ = make(lambda t: scene[0], solver=solver)
        renderer.open()
        renderer.tick(0.0)
        return scene, solver, renderer, solve_beside(renderer)

    _, solver, renderer, _ = begin()
    solver.cancelled, solved = [], 0
    while not solver.cancelled:
        solved += 1
        renderer.tick(solved * TICK)
    renderer.close()
    scene, solver, renderer, background = begin()
    for k in range(1, solved):
        renderer.tick(k * TICK)
    solver.cancelled, background.ready, started = [], False, background.started

    def play(first: int, last: int) -> int:
        """Run ticks until the result is taken, and return which is the last."""
        for k in range(first, last):
            renderer.clock.wait_until(k * TICK)
            renderer.tick(k * TICK)
            if background.started > started:
                return k
        return last

    assert play(solved, solved + 100) == solved + 100, "the ticks go on"
    if moves:
        scene[0] = pc.Scene((replace(disc, pose=pc.Pose((0.02, 0.0, 0.15))),))
        waited = play(solved + 100, solved + 200) - (solved + 100)
        assert waited <= STEERED_TIME_FACTOR * WAIT_FOR_SOLVE_AFTER / TICK + 2
    else:
        background.ready = True
        play(solved + 100, solved + 101)
    renderer.close()
    assert solver.cancelled
    assert all(solver.cancelled) if moves else not any(solver.cancelled)


def test_equal_limits_of_each_tick_are_the_same_limits() -> None:
    """A scene function may set them in each tick; only new values end the solves in the background."""
    renderer, _ = make(at)
    with renderer:
        renderer.tick(0.0)
        background = solve_beside(renderer)
        background.ready = False
        for k in range(1, 9):
            renderer.limits = pc.Limits()
            renderer.tick(k * TICK)
        assert background.started == 1
        assert renderer.report.skipped["solve, still under way"] == 7


def test_what_is_right_for_one_tick_only_is_solved_in_that_tick() -> None:
    renderer, _ = make(SCENES["stm-circle"])
    with renderer:
        renderer.tick(0.0)
        background = solve_beside(renderer)
        technique = SCENES["stm-circle"](0.0).objects[0].technique
        for k in range(1, 50):
            renderer.tick(k * TICK)
            x, y = renderer.played.rows[0].samples.positions[0, :2].tolist()
            assert np.hypot(x, y) == pytest.approx(0.015, abs=1e-6)
            assert technique.step(k * TICK) is not None
        assert background.started == 1  # a measurement


def test_an_envelope_is_followed_while_the_solve_is_under_way() -> None:
    wave = AM(frequency=125.0)
    scene = [at(0.0, technique=wave)]
    renderer, device = make(lambda t: scene[0])
    with renderer:
        for k in range(8):
            renderer.tick(k * TICK)
        background = solve_beside(renderer)
        background.ready = False
        scene[0] = at(0.001, technique=wave)
        for k in range(8, 26):
            renderer.tick(k * TICK)
            t = k * TICK + np.arange(2) * TICK / 2
            P = press(renderer.last_frame, device, [[0.0, 0.0, 0.15]])[:, 0]
            np.testing.assert_allclose(P, 5.0 * wave.factor(t), atol=0.15)


def test_the_loop_waits_for_a_solve_that_is_too_old() -> None:
    """A solver that hangs then blocks the loop, so that the guard notices missing frames."""
    clock = ManualClock()
    renderer, _ = make(at, clock=clock)
    with renderer:
        renderer.tick(0.0)
        background = solve_beside(renderer)
        background.ready = False
        for k in range(1, 300):
            clock.wait_until(k * TICK)
            renderer.tick(k * TICK)
            x = renderer.rendered_scene.objects[0].pose.position[0]
            # a measurement may run in between
            assert k * TICK - x <= 3.0 * WAIT_FOR_SOLVE_AFTER + 3 * TICK
        assert renderer.report.solves >= 3


def test_a_loop_that_catches_up_does_not_take_a_solve_for_old() -> None:
    renderer, _ = make(at)
    with renderer:
        renderer.tick(0.0)
        background = solve_beside(renderer)
        background.ready = False
        for k in range(1, 100):  # the clock stands still
            renderer.tick(k * TICK)
        assert renderer.report.solves == 1


def test_no_solution_waits_for_a_measurement() -> None:
    """A measurement runs instead of the solve that would follow."""
    renderer, _ = make(at)
    with renderer:
        for k in range(TICKS_PER_MEASUREMENT):
            renderer.tick(k * TICK)
        assert (renderer.report.solves, len(renderer.report.errors_at_samples)) == (
            TICKS_PER_MEASUREMENT,
            1,
        )
        background = solve_beside(renderer)
        while len(renderer.report.errors_at_samples) < 2:
            k += 1
            renderer.tick(k * TICK)
        report = renderer.report
        assert report.solves - TICKS_PER_MEASUREMENT == background.started - 2  # one is under way
        assert background.started > 2


AT_ITS_LIMIT = pc.Scene(
    (
        pc.Surface(
            shape=pc.Rectangle(0.03, 0.03), pose=pc.Pose((0.0, 0.0, 0.15)), radiation_pressure=30.0
        ),
    )
)


def test_only_one_measurement_is_under_way(monkeypatch: pytest.MonkeyPatch) -> None:
    """Two would use one propagator. Solves that move on in the ticks do not wait for it."""
    measure, release, threads = Probe.compute_pressures, threading.Event(), list[threading.Thread]()

    def hear(self: Probe, *about: Any) -> Any:
        threads.append(threading.current_thread())
        if threading.current_thread() is not threading.main_thread():
            release.wait(120.0)
        return measure(self, *about)

    monkeypatch.setattr(Probe, "compute_pressures", hear)
    renderer, _ = make(lambda t: at(0.02 * t))
    with renderer:
        for k in range(4 * TICKS_PER_MEASUREMENT):
            renderer.tick(k * TICK)
        assert threading.main_thread() not in threads
        assert len(threads) <= 1
        release.set()
        assert renderer.halted is None


@pytest.mark.parametrize("name", ["crowd", "palm", "sliding-ball", "static-focus", "two frames"])
def test_what_is_heard_of_a_solve_beside_the_ticks_is_what_the_device_emits(name: str) -> None:
    """The device has few levels, so that rounding matters."""
    device = Simulated(rate=1000.0, phases=8, amplitudes=2)
    scene = SCENES.get(name, AT_ITS_LIMIT)
    sampler = pc.Sampler(200 if name == "palm" else DEFAULT_BUDGET, ramp=0.005)  # then in bands
    with pc.Renderer(
        ARRAY, scene, backend=device, sampler=sampler, clock=ManualClock()
    ) as renderer:
        solve_beside(renderer)
        for k in range(20):
            renderer.tick(k * TICK)
            if renderer.samples is not None and len(renderer.samples):
                heard = renderer.compute_pressures(
                    renderer.samples.positions, renderer.played.facing
                )
                np.testing.assert_allclose(
                    renderer.sample_pressures, heard, rtol=1e-3, atol=1e-3 * heard.max()
                )
        assert len(renderer.sample_pressures)
        outcome = renderer._pipeline.played
        assert outcome.solutions.cycle or name not in ("palm", "two frames")
        assert (outcome.sample_pressures is None) is (name == "palm")  # its frames are bands
        finer = Simulated(rate=1000.0)
        finer.open(ARRAY)
        renderer.use(finer).close()
        heard = renderer.compute_pressures(renderer.samples.positions, renderer.played.facing)  # type: ignore[union-attr]
        np.testing.assert_allclose(renderer.sample_pressures, heard)


def test_what_is_heard_of_a_still_scene_is_computed_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Nor does a still scene begin many solves."""
    counted = Counter[str]()
    hear = SceneSolver._compute_pressures

    def count(self: SceneSolver, *arguments: Any) -> Any:
        counted["heard"] += 1
        return hear(self, *arguments)

    monkeypatch.setattr(SceneSolver, "_compute_pressures", count)
    with pc.Renderer(ARRAY, SCENES["static-focus"](0.0), clock=ManualClock()) as renderer:
        background = solve_beside(renderer)
        renderer._pipeline.schedule = BackgroundSchedule(TICK, in_background=True)
        for k in range(1000):
            renderer.tick(k * TICK)
        assert counted["heard"] <= 1 + renderer.report.solves
        assert background.started < 2 * 1000 * TICK / REST_INTERVAL
        assert len(renderer.sample_pressures) == 1


@pytest.mark.parametrize("since", range(0, 12, 3))
def test_a_scene_that_is_emptied_is_silent_within_the_time_that_a_client_has_to_fade(
    since: int,
) -> None:
    """A solve may have begun at any time before; solves take 4 ticks."""
    scene = [at(0.0)]
    renderer, _ = make(lambda t: scene[0])
    with renderer:
        background = renderer._pipeline.background = ManualBackground()
        renderer.schedule.in_background, begun, count = True, 0, 0
        for k in range(200):
            if background.started > count:
                begun, count = k, background.started
            background.ready = k >= begun + 4
            renderer.tick(k * TICK)
            if k > 100 and k == begun + since:
                break
        assert renderer.last_frame.amplitude.any()
        scene[0] = pc.Scene()
        last = k
        for k in range(last + 1, last + 21):
            if background.started > count:
                begun, count = k, background.started
            background.ready = k >= begun + 4
            renderer.tick(k * TICK)
        assert not renderer.last_frame.amplitude.any()


def test_a_reset_leaves_nothing_of_a_tick_without_a_frame_in_the_schedule() -> None:
    """Recordings do not contain such ticks, so a replay could not count them."""
    renderer, device = make(at)
    with renderer:
        renderer.tick(0.0)
        renderer.schedule.in_background = True
        for k in range(1, 12):
            renderer.tick(k * TICK)
        for fault in (False, True):
            if fault:
                device.stall()
                renderer.tick(12 * TICK)
                device.resume()
                renderer.schedule.in_background = False  # as after a solve that fits
            renderer.reset()
            assert renderer.schedule == BackgroundSchedule(renderer.period, in_background=True)


def test_solves_run_after_a_reset_where_they_ran_before() -> None:
    renderer, device = make(at)
    with renderer:
        renderer.tick(0.0)
        solve_beside(renderer)
        renderer.tick(TICK)
        renderer.reset()
        assert renderer.schedule.in_background
        background = solve_beside(renderer)
        background.ready = False
        for k in range(2, 20):
            renderer.tick(k * TICK)
            assert not renderer.last_frame.amplitude.any()  # there is no solution yet
        background.ready = True
        for k in range(20, 40):
            renderer.tick(k * TICK)
        assert press(renderer.last_frame, device, [[39e-3, 0.0, 0.15]])[-1, 0] == pytest.approx(
            5.0, abs=0.3
        )
        assert not renderer.report.faults
    with renderer:  # a replay also begins with solves in ticks
        assert not renderer.schedule.in_background


def test_a_deadline_is_longer_beside_the_ticks() -> None:
    seen = []

    class Notes(pc.Solver):
        name = "notes"

        def solve(self, propagator: Any, targets: Any, *rest: Any) -> pc.Result:
            *_, budget, g = rest
            seen.append(budget.due - budget.clock())
            g[:] = 0.1
            return pc.Result()

    renderer, _ = make(at, solver=Notes())
    with renderer:
        renderer.tick(0.0)
        renderer.tick(TICK)
        inside = seen[-1]
        solve_beside(renderer)
        renderer.tick(2 * TICK)
        renderer.tick(3 * TICK)
    assert seen[-1] == pytest.approx(renderer.schedule.max_ticks * inside)


def test_a_real_thread_solves_while_ticks_go_on_and_ends_with_the_renderer() -> None:
    enter, leave = threading.Event(), threading.Event()

    class Waits(pc.Solver):
        name = "waits"
        waits = False

        def solve(self, propagator: Any, targets: Any, *rest: Any) -> pc.Result:
            if self.waits:
                enter.set()
                assert leave.wait(60.0)
            rest[-1][:] = 0.1
            return pc.Result()

    solver = Waits()
    renderer, _ = make(at, solver=solver)
    before = set(threading.enumerate())
    with renderer:
        renderer.tick(0.0)
        renderer.schedule.in_background, solver.waits = True, True
        renderer.tick(TICK)
        assert enter.wait(60.0)
        for k in range(2, 20):
            renderer.tick(k * TICK)
        assert renderer.report.frames_sent == 20
        assert renderer.report.solves == 1
        threads = set(threading.enumerate()) - before
        assert len(threads) == 1
        leave.set()
        renderer.reset()  # waits for the solve
        renderer.tick(0.1)
    for thread in threads:
        thread.join(60.0)
        assert not thread.is_alive()


def test_close_waits_for_the_solve_that_runs() -> None:
    """A thread in a kernel that outlives the interpreter would abort the process."""
    begun, ended = threading.Event(), threading.Event()

    def job() -> int:
        begun.set()
        release.wait(60.0)
        ended.set()
        return 1

    release = threading.Event()
    background = BackgroundSolve[int]()
    background.start(job)
    assert begun.wait(60.0)
    assert background.running
    assert not background.done
    threading.Timer(0.01, release.set).start()
    background.close()
    assert ended.is_set()
    background.close()  # may be called twice


def test_a_program_that_forgets_to_close_ends_without_a_crash() -> None:
    program = """
import pacinian as pc
from pacinian.gallery import SCENES
renderer = pc.Renderer(pc.autd(3, 3), SCENES["palm"])
renderer.open()
renderer.tick(0.0)
renderer.schedule.in_background = True
for k in range(1, 10_000):
    renderer.tick(1e-3 * k)
    if renderer._pipeline.background.running:
        break
else:
    raise SystemExit("no solve was running at the end of a tick")
"""
    ran = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=False
    )
    assert ran.returncode == 0, ran.stderr


class Slow(ManualClock):
    """A clock that advances at each call, so that ticks that solve are long."""

    def now(self) -> float:
        self.advance(1.5e-4)
        return self.time


@pytest.mark.parametrize("name", ["palm", "crowd", "sliding-ball", "rain", "stm-circle"])
@pytest.mark.parametrize("seed", [0, 1])
def test_a_recording_comes_out_the_same_whenever_solves_are_done(
    tmp_path: Path, name: str, seed: int
) -> None:
    chance, path = np.random.default_rng(seed), tmp_path / "run.pac"
    renderer, _ = make(SCENES[name], recorder=pc.Recorder(path), clock=Slow())
    with renderer:
        background = renderer._pipeline.background = ManualBackground()
        for k in range(100):
            background.ready = bool(chance.random() < 0.4)
            if k == 70:
                renderer.limits = pc.Limits(gain=0.5)
            if k == 85:
                renderer.session.solver = "gs-pat"
            renderer.tick(k * TICK)
        assert not renderer.report.faults
        assert renderer.schedule.in_background is (name != "stm-circle")
        assert (background.started > 5) is renderer.schedule.in_background
    found = rerender(pc.Recording(path))
    assert (found.ticks, found.different) == (100, 0)


def test_its_thread_ends_with_it_even_if_nobody_closes_it() -> None:
    threads: list[threading.Thread] = []

    def start(work: Any, name: str) -> None:
        threads.append(threading.Thread(target=work, name=name, daemon=True))
        threads[0].start()

    background = BackgroundSolve[int](start)
    background.start(lambda: 3)
    assert background.take() == 3
    del background
    gc.collect()
    threads[0].join(60.0)
    assert not threads[0].is_alive()


def test_an_interruption_while_its_thread_starts_leaves_no_job_to_wait_for() -> None:
    starts: list[str] = []

    def start(work: Any, name: str) -> None:
        starts.append(name)
        if len(starts) == 1:
            raise KeyboardInterrupt
        threading.Thread(target=work, name=name, daemon=True).start()

    background = BackgroundSolve[int](start)
    with pytest.raises(KeyboardInterrupt):
        background.start(lambda: 1)
    assert not background.running
    background.drop()
    background.close()
    background.start(lambda: 2)
    assert background.take() == 2
    background.close()
