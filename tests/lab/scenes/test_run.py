"""The scenes' benchmark: what it measures is what it says; nothing here depends on how long anything takes."""

import io
import json
from dataclasses import asdict, fields, replace
from typing import Any

import numpy as np
import pytest
from rich.console import Console

import pacinian as pc
from pacinian import demo_scene, gallery
from pacinian.rendering import renderer
from pacinian.testing import ManualClock
from pacinian_lab.regions import skin
from pacinian_lab.scenes import growth, savings
from pacinian_lab.scenes import report as scene_report
from pacinian_lab.scenes import run as scenes
from pacinian_lab.scenes import tables as scene_tables
from pacinian_lab.scenes.growth import Growth
from pacinian_lab.scenes.run import Row, Run
from pacinian_lab.scenes.savings import Saving, Side, Skip
from pacinian_lab.scenes.skips import skips
from pacinian_plugins.backends.simulated import Simulated

ARRAY, ONE = pc.autd(3, 3), pc.autd()
POINT = pc.Point(position=(0.0, 0.0, 0.15), radiation_pressure=5.0)
SKIPS = {skip.what: skip for skip in skips()}
KEYS = ("scene", "p50_ms", "p99_ms", "late", "dummy_late", "rate", "solves", "lag_ms", "samples", "stages",
        "error_at_samples", "felt", "left_out")  # fmt: skip
ROW = Row(
    "palm",
    0.6,
    0.9,
    0.01,
    0.008,
    1000.0,
    400.0,
    2.5,
    60,
    {"sample": 0.2, "solve": 0.3},
    0.001,
    {"force": 1.0, "rms": 0.05, "holes": 0.0, "spill": 0.8},
    0.1,
)


@pytest.fixture(autouse=True)
def unhurried(monkeypatch: pytest.MonkeyPatch) -> None:
    """Renderers take no time by their clocks: none of their ticks is missed. No fine skin is made."""
    monkeypatch.setattr(renderer, "SystemClock", ManualClock)
    monkeypatch.setattr(skin, "_fine", lambda: None)  # of hands, which no scene of a row has here


def run(scene: Any, seconds: float = 0.06, array: pc.Array = ONE) -> Run:
    given = scene if callable(scene) else lambda t: scene
    made = Run(array, given, seconds)
    made.execute()
    return made


def test_a_row_has_the_keys_that_are_promised() -> None:
    row = scenes.measure(ONE, "empty", 0.05)
    assert tuple(asdict(row)) == tuple(field.name for field in fields(Row)) == KEYS
    assert row.scene == "empty"
    assert (row.samples, row.error_at_samples, row.felt, row.left_out) == (0, 0.0, None, 0.0)
    assert {"scene", "sample", "send"} <= row.stages.keys()
    assert json.loads(json.dumps(asdict(row))) == asdict(row)


def test_the_dummy_loop_has_as_many_ticks() -> None:
    found = run(pc.Scene((POINT,)))
    assert found.report.ticks == found.dummy.ticks == 60
    assert 1 <= len(found.evaluated) <= scenes.EVALUATED_TICKS
    row = found.row("point")
    assert row.samples == 1
    assert row.late == found.report.late_share
    assert row.dummy_late == found.dummy.late_share


def test_the_dummy_loop_burns_as_much_time_as_the_median_tick() -> None:
    class Stepping(ManualClock):
        def now(self) -> float:
            self.time += 1e-6
            return self.time

    rendering = pc.Renderer(ONE, pc.Scene((POINT,)), clock=Stepping())
    burnt = demo_scene.alternate(rendering, 0.02)
    took = rendering.report.tick_ms(50)
    assert 0.0 < took <= burnt.tick_ms(50) <= took + 2e-3


def test_the_error_is_that_of_the_session_for_what_the_device_makes() -> None:
    for scene in (pc.Scene((POINT,)), gallery.palm):
        found = run(scene, seconds=0.02)
        tick = found.evaluated[-1]
        session, samples = found.renderer.session, tick.samples
        facing = None
        if samples.capsules is not None:
            facing = pc.SkinFacing(samples.normals, samples.capsules)
        amplitudes, regions = tick.targets.amplitudes, samples.regions
        session.solve(samples.positions, amplitudes, facing=facing, regions=regions)
        every = [session.certify(g).sound_pressure for g in tick.sounding]
        mean = np.sqrt(np.mean([np.abs(p) ** 2 for p in every], axis=0))
        error = tick.targets.relative_error(mean)
        assert tick.error(session.array, session.medium) == pytest.approx(error, rel=1e-6)
        assert error > 0.0


def test_a_loop_however_late_is_given_the_scene_of_its_time() -> None:
    """The last update that was made ahead would be too old: its hand would be lost, and all silent."""
    found = run(gallery.SCENES["palm"], seconds=0.005)
    for t in (0.5, 100.0, 3000.0):
        (hand,) = found._at(t).hands
        assert hand.time is not None
        assert 0.0 <= t - hand.time < 1.01 / gallery.TRACKED


def test_nothing_is_left_out_where_all_can_be_given() -> None:
    row = run(pc.Scene((POINT,)), seconds=0.2).row("point")  # longer than the ramp
    assert row.left_out == pytest.approx(0.0, abs=0.1)


def test_what_the_array_cannot_reach_is_left_out() -> None:
    away = pc.Point(position=(0.0, 0.0, 30.0), radiation_pressure=5.0)
    tick = run(pc.Scene((POINT, away))).evaluated[-1]
    assert tick.compute_sounded(pc.Air()) == pytest.approx(tick.asked / 2.0, rel=1e-6)


def test_what_is_over_the_budget_or_too_faint_to_feel_is_left_out() -> None:
    faint = pc.Surface(
        shape=pc.Rectangle(0.3, 0.3), pose=pc.Pose((0.0, 0.0, gallery.HEIGHT + 0.004)),
        radiation_pressure=0.1,
    )  # fmt: skip
    tick = run(pc.Scene((faint,), hands=(gallery.HAND,)), array=ARRAY).evaluated[-1]
    assert tick.asked > 0.0
    assert tick.compute_sounded(pc.Air()) == 0.0


def test_a_rate_is_held_if_p99_is_within_a_tick_and_few_are_late() -> None:
    found = run(pc.Scene())
    report = found.report = pc.Report()
    found.dummy = pc.Report()
    for k in range(1000):
        report.count_tick(0.0005, late=k < 5)
        found.dummy.count_tick(0.0005, late=False)
    assert found.held
    report.count_tick(0.0005, late=True)
    assert not found.held
    found.dummy = report
    assert found.held
    for _ in range(20):
        report.count_tick(0.0011, late=False)
    assert not found.held


def test_slower_rates_are_tried_until_one_is_held(monkeypatch: pytest.MonkeyPatch) -> None:
    tried: list[float] = []

    class Slow:
        def __init__(self, array: Any, scene: Any, seconds: float, rate: float = 1000.0) -> None:
            tried.append(rate)
            self.held = rate < 400.0

        def execute(self) -> None:
            pass

        def row(self, name: str) -> Row:
            return replace(ROW, scene=name, rate=0.0)

    monkeypatch.setattr(scenes, "Run", Slow)
    assert scenes.measure(ONE, "palm", 1.0).rate == pytest.approx(1000.0 / 3.0)
    np.testing.assert_allclose(tried, [1000.0, 500.0, 1000.0 / 3.0])
    monkeypatch.setattr(scenes, "SLOWER", (2,))
    assert scenes.measure(ONE, "palm", 1.0).rate == 0.0


def test_what_goes_wrong_in_a_tick_is_raised() -> None:
    def broken(t: float) -> pc.Scene:
        if t > 0.01:
            raise ZeroDivisionError("in the scene")
        return pc.Scene()

    with pytest.raises(ZeroDivisionError, match="in the scene"):
        run(broken)
    unreadable = pc.Surface(shape=pc.Mesh(file="none.stl"), radiation_pressure=1.0)
    with pytest.raises(pc.ArgumentError, match=r"none\.stl"):
        run(pc.Scene((unreadable,)))
    side = Side(ONE, broken)
    with side.renderer, pytest.raises(ZeroDivisionError):
        side.tick(0.02)


def frames(
    skip: Skip, ticks: int = 12, array: pc.Array = ARRAY
) -> tuple[list[Any], list[Any], Side, Side]:
    """What both sides emit, tick by tick."""
    sides = Side(array, skip.on), Side(array, skip.off, skip.sampler(), skip.before)
    out: tuple[list[Any], list[Any]] = ([], [])
    with sides[0].renderer, sides[1].renderer:
        for k in range(ticks):
            for side, emitted in zip(sides, out, strict=True):
                side.tick(k * savings.PERIOD)
                device = side.renderer.backend
                assert isinstance(device, Simulated)
                emitted.append(device.frames[-1].gains(device.capability)[-1])
    return *out, *sides


SAME = [what for what in SKIPS if "reach" not in what and "faint" not in what]


@pytest.mark.parametrize("what", SAME)
def test_a_skip_changes_nothing_that_is_felt(what: str) -> None:
    on, off, _, side = frames(SKIPS[what], array=ONE)
    q = side.renderer.session.propagator.points
    p, r = (np.abs([pc.field(ONE, g, q, medium=pc.Air()) for g in gains]) for gains in (on, off))
    np.testing.assert_allclose(p, r, atol=0.02 * r.max())
    assert r.max() > 0.0


def test_with_the_skips_less_is_done() -> None:
    """By the counts that the telemetry keeps."""
    *_, on, off = frames(SKIPS["one focus: nothing changed"])
    assert on.renderer.report.solves == 1
    assert off.renderer.report.solves == 12
    *_, on, off = frames(SKIPS["1 of 41 samples moved: update one row"])
    built = [side.renderer.session.propagator.work.rows_built for side in (on, off)]
    assert built[1] == 12 * 41
    assert built[0] == 41 + 11
    *_, on, off = frames(SKIPS["1000 balls, 3 near: skip distant balls"], ticks=2)
    far = [side.renderer.report.skipped["objects away from hands"] for side in (on, off)]
    assert far == [2 * 997, 0]
    *_, on, off = frames(SKIPS["STM: reuse solutions of known steps"], ticks=30)
    assert (on.renderer.report.solves, off.renderer.report.solves) == (10, 30)
    *_, on, off = frames(SKIPS["skip a hand that is out of reach"], ticks=2)
    assert on.renderer.samples is not None
    assert not len(on.renderer.samples)


def test_a_saving_is_a_ratio_of_medians() -> None:
    found = savings.measure(ONE, SKIPS["STM: reuse solutions of known steps"], ticks=5)
    assert found.on_ms > 0.0
    assert found.ratio == found.on_ms / found.off_ms
    assert found.limit is None
    limits = {skip.what: skip.limit for skip in skips() if skip.limit is not None}
    assert set(limits.values()) == {0.02, 0.1}


def test_growth_counts_what_is_near_and_puts_another_object_in_each_tick() -> None:
    found = growth.measure(ONE, ticks=3, counts=(1, 10))
    assert [(line.objects, line.near) for line in found] == [(1, 1), (10, 3)]
    assert all(line.still_ms > 0.0 and line.replaced_ms > 0.0 for line in found)
    assert found[0].linear(found[0]) == 1.0
    game = growth.Game(5)
    a, b = game(0.0), game(0.013)
    assert [one is two for one, two in zip(a.objects, b.objects, strict=True)] == [True] * 4 + [
        False
    ]


SAVINGS = [Saving("a", 0.01, 1.0, 0.02), Saving("b", 0.5, 1.0), Saving("c", 0.2, 1.0, 0.1)]
GROWTH = [Growth(1, 1.0, 0.5, 0.5), Growth(10_000, 3.0, 0.75, 1.0)]


def test_targets_are_met_or_missed() -> None:
    slow = replace(ROW, scene="mesh", p99_ms=1.5, late=0.02, rate=500.0)
    told = {v.target: v for v in scene_report.verdicts([ROW, slow], SAVINGS, GROWTH)}
    assert [v.met for v in told.values()] == [False, False, True, False, True]
    speed = told["every scene at 1 kHz: p99 below 1 ms"]
    assert speed.found == "mesh 1.50 ms, 500 Hz held"
    assert "palm" not in "".join(v.found for v in told.values())
    assert all(v.met for v in scene_report.verdicts([ROW], SAVINGS[:2], GROWTH))
    assert not scene_report.verdicts([])


def test_everything_is_plain_for_json() -> None:
    told = scene_report.plain([ROW], SAVINGS, GROWTH, units=9)
    again = json.loads(json.dumps(told))
    assert again["rows"] == [asdict(ROW)]
    assert [one["ratio"] for one in again["savings"]] == [0.01, 0.5, 0.2]
    assert {"made", "machine", "targets", "growth", "units"} <= again.keys()


def test_tables_fit_a_terminal_and_hide_nothing() -> None:
    console = Console(width=80, file=io.StringIO())
    rows = [replace(ROW, scene=name, p50_ms=10.123, p99_ms=99.123) for name in gallery.SCENES]
    console.print(scene_tables.scenes(rows))
    console.print(scene_tables.tabulate_felt(rows))
    console.print(scene_tables.stages(rows))
    real = [Saving(skip.what, 10.0, 100.0, skip.limit) for skip in skips()]
    console.print(scene_tables.savings(real))
    console.print(scene_tables.growth(GROWTH))
    console.print(scene_tables.verdicts(scene_report.verdicts(rows, real, GROWTH)))
    text = console.file.getvalue()
    assert "…" not in text
    for word in ("textured-plane", "99.123", "10000", "missed", *SKIPS):
        assert word in text
