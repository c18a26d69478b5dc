"""The loop, on a clock that stands still: no test here sleeps."""

import math
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
import pytest

import pacinian as pc
from pacinian.testing import ManualClock
from pacinian_plugins.backends.simulated import Simulated

ARRAY = pc.autd()
POINT = pc.Point(position=(0.0, 0.0, 0.15), radiation_pressure=5.0)
SCENE = pc.Scene((POINT,))


@dataclass
class Fails(pc.Solver):
    """A solver that raises from one call on."""

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
    clock = options.setdefault("clock", ManualClock(100.0))
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


def test_what_is_emitted_makes_the_pressure_that_was_asked() -> None:
    renderer, device, _ = make()
    with renderer:
        renderer.tick()
        p = device.field([POINT.position])
        P = pc.radiation_pressure(p, pc.Air())
        assert P[0] == pytest.approx(5.0, rel=0.02)
        assert renderer.report.error < 0.01
        # the simulated array's own copy of the levels is what the report is about
        np.testing.assert_allclose(device.gains, renderer.emitted, atol=1e-6)
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
    assert report.late_ticks == 3  # the slow one, and those that began after their own end
    device.delay(0.5)
    report = renderer.run(1.0)
    assert report.skipped["missed ticks"] >= 490
    renderer.close()


def test_nothing_that_did_not_change_is_solved_again() -> None:
    renderer, _, _ = make()
    report = renderer.run(0.05)
    assert report.summary()["solves"] == 1
    assert report.skipped["solve, nothing moved"] == 49


def test_an_envelope_that_all_share_needs_no_solve() -> None:
    tremble = pc.Point(
        position=(0, 0, 0.15), radiation_pressure=5.0, envelope=pc.Sine(frequency=100.0)
    )
    renderer, device, _ = make(pc.Scene((tremble,)))
    report = renderer.run(0.02)
    assert report.summary()["solves"] == 1
    strength = [np.abs(frame.gains(device.capability)).max() for frame in device.frames][:20]
    t = np.arange(20) * 0.001
    expected = np.sqrt(0.5 - 0.5 * np.cos(2 * np.pi * 100 * t)) * max(strength)
    np.testing.assert_allclose(strength, expected, atol=0.01)


def test_envelopes_that_differ_scale_each_object() -> None:
    a = pc.Point(position=(0.03, 0, 0.15), radiation_pressure=3.0, envelope=pc.Constant(1.0))
    b = pc.Point(position=(-0.03, 0, 0.15), radiation_pressure=3.0, envelope=pc.Constant(0.25))
    renderer, device, _ = make(pc.Scene((a, b)))
    with renderer:
        renderer.tick()
        P = pc.radiation_pressure(device.field([a.position, b.position]), pc.Air())
    np.testing.assert_allclose(P, [3.0, 0.75], rtol=0.05)


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


def test_the_scene_may_be_replaced_while_it_runs() -> None:
    renderer, device, _ = make(pc.Scene())
    with renderer:
        renderer.tick()
        assert device.silent
        renderer.scene = SCENE
        renderer.tick()
        assert not device.silent
        renderer.scene = pc.Scene()
        renderer.tick()
        assert device.silent


def test_the_solver_may_be_replaced_while_it_runs() -> None:
    renderer, device, _ = make(moving)
    with renderer:
        for name in ("auto", "gs-pat", "lagrange"):
            renderer.session.solver = name  # type: ignore[assignment]
            renderer.tick()
            assert not device.silent
    assert not renderer.report.faults


def test_a_solver_that_raises_in_the_middle_silences_and_is_reported() -> None:
    renderer, device, _ = make(moving, solver=Fails(after=4))
    report = renderer.run(0.01)
    assert report.ticks == 10
    assert report.fault_count == 1
    fault = report.faults[0]
    assert (fault.stage, fault.tick) == ("solve", 3)  # one call went into warming up
    assert "in the middle of a run" in fault.message
    assert report.skipped["halted"] == 6
    assert device.silent
    assert device.received == 3


def test_after_a_fault_reset_sounds_again() -> None:
    renderer, device, _ = make(moving, solver=Fails(after=0))
    with renderer:
        renderer.tick()
        assert renderer.halted is not None
        renderer.session.solver = "auto"  # type: ignore[assignment]
        renderer.tick()
        assert device.silent
        renderer.reset()
        renderer.tick()
        assert not device.silent


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


def test_a_stalled_device_is_a_fault() -> None:
    renderer, device, _ = make(moving)
    with renderer:
        device.stall()
        renderer.tick()
        assert "stalled" in renderer.report.faults[0].message


@pytest.mark.parametrize("scene", [lambda t: 1 / 0, lambda t: None, lambda t: "scene"])
def test_a_scene_function_that_fails_is_a_fault(scene: Any) -> None:
    renderer, device, _ = make(scene)
    report = renderer.run(0.005)
    assert report.ticks == 5
    assert report.fault_count == 1
    assert report.faults[0].stage in ("scene", "sample")
    assert device.silent


def test_samples_on_a_transducer_are_left_out_and_counted() -> None:
    on = pc.Point(position=tuple(ARRAY.positions[3]), radiation_pressure=1.0)
    renderer, device, _ = make(pc.Scene((POINT, on)))
    with renderer:
        renderer.tick()
        assert not renderer.report.faults
        assert renderer.report.skipped["samples on a transducer"] == 1
        assert not device.silent


def test_an_object_a_kilometre_away_is_out_of_reach() -> None:
    far = pc.Point(position=(0.0, 0.0, 1000.0), radiation_pressure=1.0)
    renderer, device, _ = make(pc.Scene((far,)))
    with renderer:
        renderer.tick()
        assert not renderer.report.faults
        assert renderer.report.skipped["samples out of reach"] == 1
        assert device.silent


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


def test_the_gain_limit_holds_after_rounding_to_levels() -> None:
    loud = pc.Point(position=(0, 0, 0.15), radiation_pressure=1e6)
    renderer, device, _ = make(pc.Scene((loud,)), limits=pc.Limits(gain=0.5))
    with renderer:
        renderer.tick()
        assert np.abs(device.gains).max() <= 0.5 + 1e-6
        assert np.abs(device.gains).max() > 0.49


def test_a_report_is_plain_numbers() -> None:
    import json

    renderer, _, _ = make(moving)
    told = json.loads(json.dumps(renderer.run(0.01).summary()))
    assert told["ticks"] == 10
    assert told["statuses"] == {"ok": 10}
    assert {"late_ticks", "tick_p50_ms", "tick_p99_ms", "error", "skipped", "faults"} <= told.keys()


def test_the_same_scene_gives_the_same_frames() -> None:
    frames = []
    for _ in range(2):
        renderer, device, _ = make(moving)
        renderer.run(0.02)
        frames.append([(f.phase.tobytes(), f.amplitude.tobytes()) for f in device.frames])
    assert frames[0] == frames[1]


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


@pytest.mark.parametrize("error", [KeyboardInterrupt, SystemExit, GeneratorExit])
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


def test_a_look_at_what_is_emitted_leaves_the_frame_alone() -> None:
    faint = pc.Point(position=(0, 0, 0.15), radiation_pressure=50.0, envelope=pc.Constant(0.01))
    renderer, device, _ = make(pc.Scene((faint,)))
    with renderer:
        renderer.tick()
        sent = renderer._frame.amplitude.copy()
        assert np.abs(renderer.emitted).max() > 5 * np.abs(device.gains).max()
        np.testing.assert_array_equal(renderer._frame.amplitude, sent)


def test_a_power_limit_holds_after_rounding_to_levels() -> None:
    loud = pc.Point(position=(0, 0, 0.15), radiation_pressure=1e4)
    for power in (1e-3, 0.1, 3.0):
        renderer, device, _ = make(pc.Scene((loud,)), limits=pc.Limits(power=power))
        with renderer:
            renderer.tick()
            assert np.vdot(device.gains, device.gains).real <= power


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
    assert seen == pytest.approx([0.25, 0.25])


@pytest.mark.parametrize("value", [1e9, math.inf, math.nan, -5.0])
def test_an_envelope_of_any_kind_is_kept_within_0_to_1(value: float) -> None:
    class Foreign:
        def at(self, t: Any) -> Any:
            return np.full(len(t), value)

    item = pc.Point(position=(0, 0, 0.15), radiation_pressure=5.0, envelope=Foreign())  # type: ignore[arg-type]
    renderer, device, _ = make(pc.Scene((item,)))
    reference, plain, _ = make()
    with renderer, reference:
        renderer.tick()
        reference.tick()
        assert not renderer.report.faults
        assert np.abs(device.gains).max() <= np.abs(plain.gains).max() + 1e-6


@pytest.mark.parametrize(
    "options",
    [{"scene": None}, {"scene": [POINT]}, {"limits": 5}, {"sampler": 3}, {"solver": None}],
)
def test_what_is_no_part_of_a_renderer_is_refused(options: dict[str, Any]) -> None:
    with pytest.raises(pc.ArgumentError, match=next(iter(options))):
        make(**options)
