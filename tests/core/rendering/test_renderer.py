"""The render loop, on a manual clock."""

import contextlib
import math
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from msgspec.structs import replace

import pacinian as pc
from pacinian.errors import MAX_TEXT
from pacinian.gallery import SCENES
from pacinian.rendering import renderer as module
from pacinian.rendering.background_schedule import GOOD_SOLVE_TIME, MIN_FITTING, BackgroundSchedule
from pacinian.rendering.smoothing import Smoothing
from pacinian.scene.modulation.technique import LM, STM, Simultaneous
from pacinian.scene.shapes.curves import Circle
from pacinian.testing import ManualClock
from pacinian_plugins.backends.simulated import Simulated

from ...waiting import eventually
from .manual_background import ManualBackground, solve_beside

ARRAY = pc.autd()
POINT = pc.Point(position=(0.0, 0.0, 0.15), radiation_pressure=5.0)
SCENE = pc.Scene((POINT,))


@dataclass
class Fails(pc.Solver):
    """A solver that raises after `after` calls."""

    name: ClassVar[str] = "fails"
    after: int = 3
    calls: int = 0

    def solve(
        self, propagator: Any, targets: Any, limits: Any, warm: Any, budget: Any, out: Any
    ) -> pc.Result:
        self.calls += 1
        if self.calls > self.after:
            raise RuntimeError("in the middle of a run")
        out[:] = 0.5
        return pc.Result()


def make(scene: Any = SCENE, **options: Any) -> tuple[pc.Renderer, Simulated, ManualClock]:
    """Return a renderer on a manual clock. By default it has no ramps, so that targets sound at once."""
    clock = options.setdefault("clock", ManualClock(100.0))
    options.setdefault("sampler", pc.Sampler())
    options.setdefault("smoothing", Smoothing(rate=None))
    device = options.pop("backend", None) or Simulated()
    return pc.Renderer(ARRAY, scene, backend=device, **options), device, clock


def moving(t: float) -> pc.Scene:
    return pc.Scene((pc.Point(position=(0.05 * math.sin(t), 0.0, 0.15), radiation_pressure=5.0),))


def test_a_run_ticks_at_its_rate_and_ends_silent() -> None:
    renderer, device, clock = make(moving)
    report = renderer.run(0.1)
    assert report.ticks == 100
    assert report.late_ticks == 0
    assert report.frames_sent == device.received == 100
    np.testing.assert_allclose(clock.waits, 100.0 + np.arange(100) * 0.001)
    assert device.silent
    assert not device.gains.any()


def test_scene_time_begins_with_the_first_tick_however_long_the_start_takes(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A click at time 0 would else be over before anything is sent. A second run does not begin again."""
    clock, times = ManualClock(3.0), list[float]()

    @contextlib.contextmanager
    def slow() -> Iterator[None]:
        clock.advance(0.2)
        yield

    def scene(t: float) -> pc.Scene:
        times.append(t)
        return pc.Scene()

    monkeypatch.setattr(module, "realtime_section", slow)
    with pc.Renderer(ARRAY, scene, clock=clock) as renderer:
        times.clear()  # of the warm-up
        renderer.run(0.003)
        renderer.run(0.002)
    assert times == pytest.approx([0.0, 0.001, 0.002, 0.202, 0.203])


def test_what_is_emitted_makes_the_pressure_that_was_asked() -> None:
    renderer, device, _ = make()
    with renderer:
        renderer.tick()
        p = device.field([POINT.position], pc.Air())
        P = pc.radiation_pressure(p, pc.Air())
        assert P[0] == pytest.approx(5.0, rel=0.02)
        assert renderer.report.error_at_samples < 0.01
        # the report evaluates the levels that the simulated array holds
        np.testing.assert_allclose(device.gains, renderer.emitted_gains, atol=1e-6)
    assert device.silent


def test_a_tick_that_ends_after_the_next_ones_due_time_is_late() -> None:
    clock = ManualClock()
    renderer, device, _ = make(clock=clock, backend=Simulated(wait=clock.advance))
    with renderer:
        device.delay(0.0009)
        renderer.tick()
        assert renderer.report.late_ticks == 0
        device.delay(0.0011)
        renderer.tick()
        assert renderer.report.late_ticks == 1
    assert renderer.report.tick_ms(100) == pytest.approx(1.1)


def test_after_a_late_tick_the_loop_catches_up_and_after_a_long_stop_it_does_not() -> None:
    clock = ManualClock()
    renderer, device, _ = make(clock=clock, backend=Simulated(wait=clock.advance))
    renderer.open()
    device.delay(0.0035)
    report = renderer.run(0.01)
    assert report.ticks == 10
    assert report.late_ticks == 3  # the slow tick, and two that began after their own end
    device.delay(0.5)
    report = renderer.run(1.0)
    assert report.skipped["missed ticks"] >= 490
    renderer.close()


def test_a_loop_that_makes_up_for_nothing_leaves_out_what_is_over() -> None:
    clock = ManualClock()
    renderer, device, _ = make(clock=clock, backend=Simulated(wait=clock.advance))
    renderer.open()
    device.delay(0.0035)
    report = renderer.run(0.01, max_lag=0.0)
    assert report.skipped["missed ticks"] == 2
    assert report.ticks == 8
    assert report.late_ticks == 1
    with pytest.raises(pc.ArgumentError, match="max_lag"):
        renderer.run(0.01, max_lag=-1.0)
    renderer.close()


def test_frames_follow_the_devices_rate() -> None:
    tremble = pc.Point(
        position=(0, 0, 0.15), radiation_pressure=5.0, envelope=pc.Sine(frequency=500.0)
    )
    renderer, device, _ = make(pc.Scene((tremble,)), backend=Simulated(rate=4000.0))
    renderer.run(0.003)
    assert device.frames[0].phase.shape == (4, 249)
    loud = [bool(row.any()) for frame in list(device.frames)[:2] for row in frame.amplitude]
    assert loud == [False, True, True, True, True, True, True, True]


def test_a_device_slower_than_the_loop_is_refused() -> None:
    with pytest.raises(pc.ArgumentError, match="rate"):
        make(backend=Simulated(rate=500.0))


def test_a_solver_that_raises_in_the_middle_silences_and_is_reported() -> None:
    renderer, device, _ = make(moving, solver=Fails(after=4))
    report = renderer.run(0.01)
    assert report.ticks == 10
    assert report.fault_count == 1
    fault = report.faults[0]
    assert (fault.stage, fault.tick) == ("solve", 2)  # two calls were the warm-up
    assert "in the middle of a run" in fault.message
    assert report.skipped["halted"] == 7
    assert device.silent
    assert device.received == 2


def test_a_device_that_is_unplugged_ends_in_silence_and_a_fault() -> None:
    renderer, device, _ = make(moving)
    with renderer:
        renderer.tick()
        device.disconnect()
        renderer.tick()
        renderer.tick()
        assert [fault.stage for fault in renderer.report.faults] == ["send"]
        assert "disconnected" in renderer.report.faults[0].message
        assert device.silent
        device.reconnect()
        renderer.reset()
        renderer.tick()
        assert not device.silent


@pytest.mark.parametrize("scene", [lambda t: 1 / 0, lambda t: None])
def test_a_scene_function_that_fails_is_a_fault(scene: Any) -> None:
    renderer, device, _ = make(scene)
    report = renderer.run(0.005)
    assert report.ticks == 5
    assert report.fault_count == 1
    assert report.faults[0].stage in ("scene", "sample")
    assert device.silent


def test_of_what_is_raised_little_is_kept() -> None:
    def scene(t: float) -> pc.Scene:
        raise RuntimeError("x" * 10**7)

    renderer, _, _ = make(scene)
    with renderer:
        for _ in range(3):
            renderer.tick()
            renderer.reset()
    faults = renderer.report.faults
    assert len(faults) == 3
    assert max(len(fault.message) for fault in faults) <= MAX_TEXT
    assert [fault.error is None for fault in faults] == [True, True, False]


def test_what_is_out_of_reach_is_left_out_and_counted() -> None:
    on = pc.Point(position=tuple(ARRAY.positions[3]), radiation_pressure=1.0)
    far = pc.Point(position=(0.0, 0.0, 1000.0), radiation_pressure=1.0)
    renderer, device, _ = make(pc.Scene((POINT, on, far)))
    with renderer:
        renderer.tick()
        assert not renderer.report.faults
        assert renderer.report.skipped["samples on a transducer"] == 1
        assert renderer.report.skipped["objects away from hands"] == 1
        assert not device.silent


def test_ctrl_c_ends_in_silence() -> None:
    renderer, device, _ = make(moving)

    def interrupt(report: pc.Report) -> None:
        if report.ticks == 5:
            raise KeyboardInterrupt

    report = renderer.run(1.0, interrupt)
    assert report.interrupted
    assert report.ticks == 5
    assert device.silent


def test_an_exception_of_the_callers_own_still_ends_in_silence() -> None:
    renderer, device, _ = make(moving)
    with pytest.raises(ZeroDivisionError):
        renderer.run(1.0, lambda report: 1 / 0)
    assert device.silent


def test_a_report_is_plain_numbers() -> None:
    import json

    renderer, _, _ = make(moving)
    told = json.loads(json.dumps(renderer.run(0.01).summary()))
    assert told["ticks"] == 10
    assert told["statuses"] == {"ok": 10}
    assert {
        "late_ticks",
        "tick_p50_ms",
        "tick_p99_ms",
        "error_at_samples",
        "felt",
        "skipped",
        "faults",
    } <= told.keys()


def test_a_report_prints_what_a_person_wants_to_know() -> None:
    assert repr(pc.Report()) == "<Report: no ticks yet>"
    renderer, _, _ = make(moving)
    calm = repr(renderer.run(0.01))
    assert re.fullmatch(
        r"<Report: 10 ticks, 0.0% late, median \d+.\d\d ms(, error at samples \d+.\d\d%)?>", calm
    )
    renderer, _, _ = make(lambda t: 1 / 0)
    broken = repr(renderer.run(0.01))
    assert "1 faults, the last in scene: ZeroDivisionError" in broken
    assert len(broken) < 300


def test_a_device_that_refuses_to_be_silent_is_asked_again() -> None:
    renderer, device, _ = make(lambda t: moving(t) if renderer.report.ticks < 2 else 1 / 0)
    with renderer:
        renderer.tick()
        renderer.tick()
        device.refuse_silence(3)
        renderer.tick()
        assert renderer.halted is not None
        assert not device.silent
        for _ in range(3):
            renderer.tick()
        assert device.silent
        assert renderer.report.fault_count == 1


@pytest.mark.parametrize("error", [KeyboardInterrupt, SystemExit])
def test_whatever_interrupts_the_silence_the_device_is_closed(error: type[BaseException]) -> None:
    class Interrupted(Simulated):
        calls: ClassVar[list[str]] = []
        times = 1

        def silence(self) -> None:
            self.calls.append("silence")
            if self.times:
                self.times -= 1
                raise error
            super().silence()

        def close(self) -> None:
            self.calls.append("close")
            super().close()

    Interrupted.calls = []
    renderer, device, _ = make(moving, backend=Interrupted())
    if error is KeyboardInterrupt:
        assert renderer.run(0.01).interrupted
    else:
        with pytest.raises(error):
            renderer.run(0.01)
    assert device.silent
    assert "close" in Interrupted.calls


@pytest.mark.parametrize("error", [KeyboardInterrupt, SystemExit])
def test_an_interruption_while_opening_gives_the_device_back(error: type[BaseException]) -> None:
    class Stops(pc.Solver):
        name = "stops"

        def solve(self, *arguments: Any) -> pc.Result:
            raise error

    renderer, device, _ = make(solver=Stops())
    with pytest.raises(error):
        renderer.open()
    assert device.silent
    with pytest.raises(pc.BackendError, match="not open"):
        device.send(pc.Frame(0, 0.0, np.zeros((1, 249), np.uint16), np.ones((1, 249), np.uint16)))


def test_a_renderer_that_is_not_open_does_not_tick() -> None:
    renderer, device, _ = make()
    for _ in range(2):
        with pytest.raises(pc.BackendError, match="not open"):
            renderer.tick()
        assert device.silent
        renderer.open()
        renderer.close()


def test_a_recorded_wave_is_loaded_before_the_first_tick() -> None:
    wave = pc.Wave(samples=(0.0, 0.5, -0.5), rate=1000.0)
    point = pc.Point(position=(0.0, 0.0, 0.15), radiation_pressure=5.0, envelope=wave)
    renderer, _, _ = make(pc.Scene((point,)))
    assert "_table" not in wave.__dict__
    with renderer:
        assert "_table" in wave.__dict__


def test_a_look_at_what_is_emitted_leaves_the_frame_alone() -> None:
    faint = pc.Point(position=(0, 0, 0.15), radiation_pressure=50.0, envelope=pc.Constant(0.01))
    renderer, device, _ = make(pc.Scene((faint,)))
    with renderer:
        renderer.tick()
        sent = renderer.last_frame.amplitude.copy()
        assert np.abs(renderer.emitted_gains).max() > 5 * np.abs(device.gains).max()
        np.testing.assert_array_equal(renderer.last_frame.amplitude, sent)


@pytest.mark.parametrize(
    "limits", [pc.Limits(gain=0.5), *(pc.Limits(power=power) for power in (1e-3, 0.1, 3.0))]
)
def test_limits_hold_after_rounding_to_levels(limits: pc.Limits) -> None:
    loud = pc.Point(position=(0, 0, 0.15), radiation_pressure=1e4)
    renderer, device, _ = make(pc.Scene((loud,)), limits=limits)
    with renderer:
        renderer.tick()
        g = device.gains
        if limits.power is not None:
            assert np.vdot(g, g).real <= limits.power
        else:
            assert 0.49 < np.abs(g).max() <= 0.5 + 1e-6


def test_an_object_that_is_off_changes_nothing() -> None:
    off = pc.Point(position=POINT.position, radiation_pressure=3.0, envelope=pc.Constant(0.0))
    alone, with_off = (make(pc.Scene(objects)) for objects in ((POINT,), (POINT, off)))
    gains = []
    for renderer, device, _ in (alone, with_off):
        with renderer:
            renderer.tick()
            gains.append(device.gains)
    np.testing.assert_array_equal(*gains)


def test_a_change_of_limits_or_solver_is_followed_though_nothing_moved() -> None:
    renderer, device, _ = make()
    with renderer:
        renderer.tick()
        renderer.limits = pc.Limits(power=0.01)
        renderer.tick()
        assert np.vdot(device.gains, device.gains).real <= 0.01
        renderer.session.solver = "gs-pat"  # type: ignore[assignment]
        renderer.tick()
        assert renderer.solution is not None
        assert renderer.solution.solver == "gs-pat"


def test_it_is_still_once_a_frame_repeats_and_until_something_new_is_seen() -> None:
    renderer, _, clock = make()

    def look() -> bool:
        renderer.tick()
        clock.advance(renderer.period)
        return renderer.repeats

    with renderer:
        assert not renderer.repeats
        for P in (5.0, 3.0):
            renderer.scene = pc.Scene((replace(POINT, radiation_pressure=P),))
            assert not look()
            eventually(lambda: all(look() for _ in range(10)))  # after a measurement in a thread
        background = solve_beside(renderer)
        background.ready = False
        assert not look(), "a solve is under way"
        background.ready = True
        assert [look() for _ in range(3)] == [False] * 3, "each tick begins another solve"
        renderer.restart()
        assert not renderer.repeats


def test_a_hand_that_moves_through_empty_space_needs_no_solve() -> None:
    item = pc.Volume(shape=pc.Sphere(0.02), pose=pc.Pose((0.0, 0.0, 0.15)), radiation_pressure=5.0)
    hands = [pc.Hand.open("right", pc.Pose((0.001 * k, 0.0, 0.4))) for k in range(20)]
    renderer, _, clock = make(pc.Scene((item,)))
    with renderer:
        for hand in hands:
            renderer.scene = pc.Scene((item,), hands=(hand,))
            renderer.tick()
            clock.advance(renderer.period)
        assert renderer.repeats
        assert renderer.report.solves == 1
        renderer.scene = pc.Scene((item,), hands=(pc.Hand.open("right", pc.Pose((0, 0, 0.17))),))
        renderer.tick()
        assert not renderer.repeats
        assert renderer.report.solves == 2


def test_a_busy_moment_is_over_after_some_seconds_of_silence_though_a_hand_moves() -> None:
    renderer, _, clock = make()
    hands = [pc.Hand.open("right", pc.Pose((0.001 * k, 0.0, 0.4))) for k in range(2)]
    with renderer:
        renderer._pipeline.background = ManualBackground()
        renderer._pipeline.schedule = BackgroundSchedule(renderer.period, in_background=True)
        renderer.tick()
        renderer._pipeline._allowed = 32
        assert renderer._pipeline.budget_controller is not None
        renderer._pipeline.budget_controller.allowed = 32
        for k in range(9 * MIN_FITTING):
            renderer.scene = pc.Scene(hands=(hands[k // 4 % 2],))
            renderer.tick()
            clock.advance(renderer.period)
        assert renderer.report.solves == 2  # the point, and silence
        assert not renderer.schedule.in_background
        assert renderer._pipeline._allowed == renderer.sampler.budget


def test_what_is_remembered_of_the_last_solution_is_intact() -> None:
    seen: list[float] = []

    class Looks(pc.Solver):
        name = "looks"

        def solve(
            self, propagator: Any, targets: Any, limits: Any, warm: Any, budget: Any, out: Any
        ) -> pc.Result:
            if warm is not None:
                seen.append(float(np.abs(warm.gains).max()))
            out[:] = 0.25
            return pc.Result()

    calls = iter(range(10))
    renderer, _, _ = make(lambda t: moving(t + 0.1 * next(calls)), solver=Looks())
    with renderer:
        for _ in range(3):
            renderer.tick()
    assert seen[-2:] == pytest.approx([0.25, 0.25])  # earlier ones are from the warm-up


@pytest.mark.parametrize(
    "options",
    [{"scene": None}, {"scene": [POINT]}, {"limits": 5}, {"sampler": 3}, {"solver": None}],
)
def test_what_is_no_part_of_a_renderer_is_refused(options: dict[str, Any]) -> None:
    with pytest.raises(pc.ArgumentError, match=next(iter(options))):
        make(**options)


def loudest(device: Simulated) -> list[float]:
    """Return the largest gain of each row that was sent."""
    rows = np.concatenate([frame.gains(device.capability) for frame in device.frames])
    return np.abs(rows).max(axis=1).tolist()


def running(renderer: pc.Renderer, clock: ManualClock, ticks: int) -> None:
    for _ in range(ticks):
        renderer.tick()
        clock.advance(renderer.period)


@pytest.mark.parametrize("rows", [1, 2, 5])
def test_sound_comes_up_from_silence_and_then_the_same_rows_are_sent(rows: int) -> None:
    loud = pc.Point(position=(0.0, 0.0, 0.15), radiation_pressure=150.0)
    device = Simulated(rate=1000.0 * rows, amplitudes=1 << 16, phases=1 << 16)
    options: dict[str, Any] = {"sampler": None, "smoothing": None}  # the defaults
    renderer, _, clock = make(pc.Scene((loud,)), backend=device, **options)
    with renderer:
        running(renderer, clock, 20)
        sizes = np.array(loudest(device))
        assert sizes[0] <= 0.75 / rows + 1e-3
        assert sizes[-1] > 0.5
        assert (np.diff(sizes) >= -1e-3).all()
        gains = np.concatenate([frame.gains(device.capability) for frame in device.frames])
        assert np.abs(np.diff(gains, axis=0)).max() <= 0.75 / rows + 1e-3
        last = list(device.frames)[-5:]
        for frame in last:
            assert (frame.phase == last[0].phase[0]).all()
            assert (frame.amplitude == last[0].amplitude[0]).all()
        assert renderer.report.skipped["drive, nothing changed"] >= 10
        assert [frame.sequence for frame in device.frames] == list(range(20))
        np.testing.assert_allclose(np.diff([frame.time for frame in device.frames]), 0.001)


@pytest.mark.parametrize("how", ["reset", "run", "fault", "interrupted"])
def test_sound_comes_up_from_silence_again(how: str) -> None:
    loud = pc.Point(position=(0.0, 0.0, 0.15), radiation_pressure=150.0)
    options: dict[str, Any] = {"sampler": None, "smoothing": None}
    renderer, device, clock = make(pc.Scene((loud,)), **options)
    with renderer:
        renderer.run(0.02)
        assert loudest(device)[-2] > 0.5
        if how == "reset":
            renderer.reset()
        elif how == "fault":
            running(renderer, clock, 20)
            device.stall()
            renderer.tick()
            device.resume()
            renderer.reset()
        elif how == "interrupted":
            renderer.run(0.02, lambda report: (_ for _ in ()).throw(KeyboardInterrupt))
        device.frames.clear()
        renderer.run(0.02)
        sizes = loudest(device)[:20]
        assert sizes[0] < 0.3
        assert sizes[-1] > 0.5


def test_times_of_the_stages_add_up_to_that_of_the_tick(tmp_path: Path) -> None:
    clock = ManualClock()

    class Slowly(pc.Solver):
        name = "slowly"

        def solve(self, *arguments: Any) -> pc.Result:
            clock.advance(0.0004)
            arguments[-1][:] = 0.1
            return pc.Result()

    class Writes(pc.Recorder):
        def write(self, *arguments: Any, **options: Any) -> None:
            clock.advance(0.0008)
            super().write(*arguments, **options)

    def scene(t: float) -> pc.Scene:
        clock.advance(0.0002)
        return moving(t)

    device = Simulated(wait=clock.advance)
    recorder = Writes(tmp_path / "run.pac")
    options: dict[str, Any] = {"adaptive": False, "recorder": recorder}
    renderer, _, _ = make(scene, clock=clock, backend=device, solver=Slowly(), **options)
    with renderer:
        device.delay(0.0016, 10)
        for _ in range(10):
            renderer.tick()
        stages = renderer.report.summary()["stages_ms"]
        expected = {"scene": 0.2, "sample": 0.0, "solve": 0.4, "drive": 0.0, "send": 1.6}
        assert stages == pytest.approx({**expected, "record": 0.8})
        assert sum(stages.values()) == pytest.approx(renderer.report.tick_ms(50))


class Busy(ManualClock):
    """A clock that advances by `cost` [s] at each call."""

    cost = 4e-5

    def now(self) -> float:
        self.advance(self.cost)
        return self.time


def test_all_of_a_tick_but_its_first_and_last_look_at_the_clock_is_in_a_stage() -> None:
    clock = Busy()
    renderer, _, _ = make(moving, clock=clock, adaptive=False)
    with renderer:
        for _ in range(100):
            renderer.tick()
    told = sum(renderer.report.summary()["stages_ms"].values())
    mean = 1e3 * renderer.report.recent(100).mean()
    assert mean - told == pytest.approx(2e3 * clock.cost, rel=1e-6)


def test_the_error_is_that_of_the_points_of_its_own_step() -> None:
    runs = pc.Point(
        position=(0, 0, 0.15),
        radiation_pressure=5.0,
        technique=STM(frequency=100.0, along=Circle(0.02)),
    )
    for rows in (1, 2, 4):
        renderer, _, _ = make(
            pc.Scene((runs,)), backend=Simulated(rate=1000.0 * rows), adaptive=False
        )
        report = renderer.run(0.1)
        # in tick TICKS_TO_FIRST_MEASUREMENT, and TICKS_PER_MEASUREMENT later
        assert len(report.errors_at_samples) == 2
        assert 0.0 < report.error_at_samples < 0.02


def test_exact_samples_may_be_asked_for_while_sound_comes_up() -> None:
    off = pc.Point(position=(0.03, 0, 0.15), radiation_pressure=0.0)
    other = pc.Point(position=(-0.03, 0, 0.15), radiation_pressure=3.0)
    options: dict[str, Any] = {"sampler": None, "limits": pc.Limits(exact=[0])}
    renderer, device, clock = make(pc.Scene((POINT, off, other)), **options)
    with renderer:
        running(renderer, clock, 20)
        assert not renderer.report.faults
        P = pc.radiation_pressure(device.field([POINT.position], pc.Air()), pc.Air())
        assert P[0] == pytest.approx(5.0, rel=0.03)


@pytest.mark.parametrize(
    ("adaptive", "technique"),
    [(True, Simultaneous()), (False, Simultaneous()), (True, LM(90.0, 0.003))],
)
def test_ticks_that_are_late_have_fewer_samples_until_there_is_time_again(
    adaptive: bool, technique: Any
) -> None:
    clock = ManualClock()
    side = (0.0085 * np.arange(-5.5, 6.0)).tolist()
    plates = [
        pc.Particles(
            positions=tuple((u, v, 0.0) for u in side for v in side),
            pose=pc.Pose((x, 0, 0.2)),
            radiation_pressure=0.1,
            technique=technique,
        )
        for x in (0.0, 0.001, 0.002)
    ]
    solves = 1 if technique.keeps_places else 2  # solves per tick
    cost = 4e-5 / solves  # per sample [s]

    class Slowly(pc.Solver):
        name = "slowly"

        def solve(self, propagator: Any, targets: Any, *rest: Any) -> pc.Result:
            clock.advance(cost * len(targets.amplitudes))
            rest[-1][:] = 0.1
            return pc.Result()

    calls = iter(range(10_000))
    renderer, _, _ = make(
        lambda t: pc.Scene((plates[next(calls) % 3],)),
        clock=clock,
        solver=Slowly(),
        adaptive=adaptive,
        backend=Simulated(rate=2000.0),
    )
    with renderer:
        renderer._pipeline.background = ManualBackground()
        assert renderer.samples is None
        renderer.tick()
        assert renderer.samples is not None
        whole = len(renderer.samples)
        assert whole * cost * solves > 2 * renderer.period
        for _ in range(200):
            renderer.tick()
        few = len(renderer.samples)
        assert (few < whole) is adaptive
        # that a solve may take [s]
        most = GOOD_SOLVE_TIME if technique.keeps_places else renderer.period
        assert not adaptive or (few >= 16 and few * cost * solves <= most)
        # includes solves in the background, which this test runs in them
        late = renderer.report.late_ticks
        assert adaptive is (late < 60) or (adaptive and technique.keeps_places)
        cost = 1e-7
        for _ in range(2000):
            renderer.tick()
            if renderer.sampler.allowed == renderer.sampler.budget:
                break
        renderer.tick()
        assert len(renderer.samples) == whole
        assert renderer.sampler.allowed == renderer.sampler.budget
        renderer.reset()
        assert renderer.sampler.allowed == renderer.sampler.budget


@pytest.mark.parametrize("due", [-1e9, 1e9, 99.0, math.nan, math.inf])
@pytest.mark.parametrize("name", ["palm", "stm-circle", "sliding-ball"])
def test_time_may_jump_or_stand_still(due: float, name: str) -> None:
    renderer, device, clock = make(SCENES[name], sampler=None, smoothing=None)
    with renderer:
        running(renderer, clock, 3)
        for _ in range(3):
            renderer.tick(due)
        for _ in range(3):
            renderer.tick()  # the clock stands still
        if renderer.halted is not None:
            assert device.silent
            assert not math.isfinite(due)
            renderer.reset()
        running(renderer, clock, 10)
        assert renderer.halted is None
        assert renderer.report.ticks == 19
        assert not device.silent


@pytest.mark.parametrize("nonsense", [None, SCENE.objects, pc.Scene, math.nan])
def test_nonsense_in_place_of_a_scene_or_limits_is_a_fault_and_no_crash(nonsense: Any) -> None:
    for name in ("scene", "limits"):
        renderer, device, _ = make()
        with renderer:
            renderer.tick()
            setattr(renderer, name, nonsense)
            renderer.tick()
            assert renderer.halted is not None
            assert device.silent
            setattr(renderer, name, SCENE if name == "scene" else pc.Limits())
            renderer.reset()
            renderer.tick()
            assert not device.silent
            assert renderer.report.fault_count == 1


def test_what_was_read_from_the_clock_is_not_heaped_up() -> None:
    renderer, _, _ = make(lambda t: moving(t) if renderer.report.ticks % 7 else 1 / 0)
    with renderer:
        for _ in range(200):
            renderer.tick()
            renderer.reset()
        assert len(renderer.recording_clocks.tick.take()) < 20


STATES = {
    "left": pc.Scene((pc.Point(position=(-0.03, 0, 0.15), radiation_pressure=5.0),)),
    "right": pc.Scene((pc.Point(position=(0.03, 0, 0.15), radiation_pressure=3.0),)),
    "both": pc.Scene(
        (
            pc.Point(position=(-0.03, 0, 0.15), radiation_pressure=2.0),
            pc.Point(position=(0.03, 0, 0.15), radiation_pressure=8.0, envelope=pc.Constant(0.5)),
        )
    ),
    "none": pc.Scene(),
}
ASKED = {"left": (5.0, None), "right": (None, 3.0), "both": (2.0, 4.0), "none": (0.0, 0.0)}
steps = st.lists(
    st.one_of(
        st.sampled_from(list(STATES)),
        st.sampled_from(["power", "free", "auto", "lagrange", "again", "reset"]),
    ),
    max_size=25,
)


@settings(max_examples=40)
@given(steps)
def test_whatever_changes_and_in_whatever_order_what_is_sent_is_what_is_asked(script: Any) -> None:
    device = Simulated(phases=1 << 16, amplitudes=1 << 16, rate=2000.0)
    renderer, _, clock = make(STATES["left"], backend=device)
    state, power = "left", math.inf
    with renderer:
        for step in ("again", *script):
            if step in STATES:
                state, renderer.scene = step, STATES[step]
            elif step in ("power", "free"):
                power = 0.05 if step == "power" else math.inf
                renderer.limits = pc.Limits(power=None if step == "free" else power)
            elif step == "reset":
                renderer.reset()
            elif step != "again":
                renderer.session.solver = step
            solves = renderer.report.solves
            running(renderer, clock, 1)
            assert not renderer.report.faults
            assert step != "again" or not solves or renderer.report.solves == solves
            for row in device.frames[-1].gains(device.capability):
                assert np.vdot(row, row).real <= power
                p = pc.field(ARRAY, row, [(-0.03, 0, 0.15), (0.03, 0, 0.15)], medium=pc.Air())
                for P, wanted in zip(pc.radiation_pressure(p, pc.Air()), ASKED[state], strict=True):
                    if wanted is not None and power == math.inf:
                        assert pytest.approx(wanted, rel=0.03) == P


@pytest.mark.parametrize(("level", "met"), [(3.0, True), (40.0, False)])
def test_what_there_was_no_time_for_is_solved_on_as_long_as_that_helps(
    level: float, met: bool
) -> None:
    clock = Busy()
    clock.cost = 4e-4
    side = 0.0085 * np.arange(-3.0, 4.0)
    places = tuple((x, y, 0.2) for x in side.tolist() for y in side.tolist())
    points = pc.Particles(positions=places, radiation_pressure=level)
    renderer, _, _ = make(pc.Scene((points,)), clock=clock, solver="lbfgs")
    errors, solves = [], []
    with renderer:
        renderer.schedule.period = math.inf  # no tick is long, so every tick solves
        for _ in range(40):
            renderer.tick()
            assert renderer.solution is not None
            errors.append(renderer.solution.error)
            solves.append(renderer.report.solves)
        assert renderer.report.statuses["deadline"] >= 2
        assert renderer.report.statuses["ok"] == met
    assert errors == sorted(errors, reverse=True)
    assert errors[-1] < 0.98 * errors[0]
    assert solves[-1] == solves[-20] < 20
    assert renderer.modulator.steady


class Halves(pc.Solver):
    """A solver that halves the error of a focus each time it has time."""

    name = "halves"

    def __init__(self) -> None:
        self.missing = 1.0

    def solve(self, propagator, targets, limits, warm, budget, out):  # type: ignore[no-untyped-def]
        if not budget.spent:
            self.missing /= 2.0
        full = targets.amplitudes[0] / propagator.gram[0, 0].real
        out[:] = (1.0 - self.missing) * full * propagator.adjoint(np.ones(1, np.complex64))
        return pc.Result(late=True)


@pytest.mark.parametrize("busy", [range(3), range(1, 4), range(3, 7), range(700), range(9, 700)])
def test_ticks_without_time_to_solve_do_not_end_it_for_those_that_have(busy: range) -> None:
    clock = Busy()
    point = pc.Point(position=(0.0, 0.0, 0.15), radiation_pressure=5.0)
    renderer, _, _ = make(pc.Scene((point,)), clock=clock, solver=Halves(), adaptive=False)
    errors = []
    with renderer:
        for k in range(1000):
            clock.cost = 1.0 if k in busy else 4e-5
            renderer.tick()
            assert renderer.solution is not None
            errors.append(renderer.solution.error)
    assert errors == sorted(errors, reverse=True)
    assert errors[-1] < 1e-3
    assert renderer.modulator.steady
    assert renderer.report.solves < 40


def test_its_text_says_what_it_renders_and_how_it_goes() -> None:
    renderer = pc.Renderer(ARRAY, pc.Scene((POINT,)), clock=ManualClock())
    assert repr(renderer).startswith("<Renderer of 1 objects by auto on Simulated, ")
    assert f"{len(ARRAY)} transducers, 1000 Hz: 0 ticks, 0 late>" in repr(renderer)
    renderer.run(0.003)
    assert ": 3 ticks, " in repr(renderer)
    assert "halted" not in repr(renderer)
    assert "a moving scene" in repr(pc.Renderer(ARRAY, lambda t: pc.Scene()))
    samples = renderer.samples
    assert samples is not None
    assert repr(samples).startswith("<1 samples of 1 objects, ")
    assert "Pa, " in repr(samples)
    assert repr(pc.Sampler().sample(pc.Scene())) == "<0 samples of 0 objects>"


@pytest.mark.parametrize(
    ("item", "field", "file"),
    [
        (
            replace(POINT, envelope=pc.Wave("no.wav"), name="bell"),
            "envelope",
            "'bell' needs no.wav",
        ),
        (pc.Volume(shape=pc.Mesh("no.stl"), force=0.1), "shape", "number 0 needs no.stl"),
        (
            pc.Volume(shape=pc.Union((pc.Sphere(0.01), pc.Placed(pc.Mesh("no.obj")))), force=0.1),
            "shape",
            "needs no.obj",
        ),
    ],
)
def test_a_missing_file_is_told_before_the_run(item: Any, field: str, file: str) -> None:
    with pytest.raises(pc.ArgumentError, match=file) as caught:
        pc.Renderer(ARRAY, pc.Scene((item,)))
    assert caught.value.argument == field


@pytest.mark.parametrize("where", ["open", "scene", "warnings"])
def test_a_run_that_is_interrupted_while_it_opens_ends_and_closes_the_device(
    where: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    class Opened(Simulated):
        opened = False

        def open(self, array: pc.Array) -> None:
            super().open(array)
            self.opened = True
            if where == "open":
                raise KeyboardInterrupt

        def close(self) -> None:
            super().close()
            self.opened = False

    def interrupted(*_: object) -> Any:
        raise KeyboardInterrupt

    if where == "warnings":
        monkeypatch.setattr("pacinian.rendering.pipeline.find_warnings", interrupted)
    device = Opened()
    scene = interrupted if where == "scene" else moving
    renderer = pc.Renderer(pc.autd(1, 1), scene, backend=device)
    assert renderer.run(0.01).interrupted
    assert not device.opened
    assert device.silent
