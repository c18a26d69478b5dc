"""The loop's measurements between samples and on skin, against all points, and against an independent field."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import pacinian as pc
from pacinian.rendering.emitted_measurement import SAMPLES, Probe
from pacinian.rendering.measurement_schedule import MAX_MEASUREMENTS_AT_REST
from pacinian.solving.felt_figures import FeltSums
from pacinian.testing import ManualClock
from pacinian_lab.regions.contacts import CONTACTS
from pacinian_lab.regions.skin import measure_felt
from pacinian_plugins.backends.simulated import Simulated

AIR, ARRAY = pc.Air(), pc.autd()
MIDDLE = ARRAY.centre + np.array([0.0, 0.0, 0.2])


def solved(*items: Any, **how: Any) -> tuple[pc.Session, pc.Samples, pc.Solution]:
    sampler = pc.Sampler(1000)
    sampler.prepare(ARRAY, AIR)
    samples = sampler.sample(pc.Scene(items))
    session = pc.Session(ARRAY, AIR)
    amplitudes = pc.sound_pressure(samples.radiation_pressure, AIR)
    solution = session.solve(samples.positions, amplitudes, **{"regions": samples.regions} | how)
    return session, samples, solution


def disc(x: float, pressure: float, name: str = "") -> pc.Surface:
    pose = pc.Pose((MIDDLE[0] + x, MIDDLE[1], MIDDLE[2]))
    return pc.Surface(shape=pc.Disc(0.012), pose=pose, radiation_pressure=pressure, name=name)


def measured(session: pc.Session, samples: pc.Samples, solution: pc.Solution, times: int) -> Any:
    probe, sums = Probe(session), dict[str, FeltSums]()
    for _ in range(times):
        for name, found in probe.measure_between(
            samples, solution.targets, session.propagator.facing, solution.gains[None]
        ).items():
            sums[name] = sums.get(name, FeltSums()).plus(found)
    return {name: all_.felt for name, all_ in sums.items()}


@pytest.mark.parametrize("strength", [1.0, 0.3])
def test_many_measurements_find_what_all_places_say(strength: float) -> None:
    session, samples, solution = solved(disc(-0.02, 1.0, "one"), disc(0.02, 2.0, "two"))
    solution.gains[:] *= np.float32(strength)  # as if the device had weakened them
    every = session.measure_felt(solution).felt
    found = measured(session, samples, solution, 100)
    assert found.keys() == {"one", "two"}
    for name, some in found.items():
        first = samples.items[samples.objects[0]].name
        all_ = every[0 if name == first else 1]
        assert some.force == pytest.approx(strength**2, abs=0.03)
        assert some.force == pytest.approx(all_.force, abs=0.01)
        assert some.rms == pytest.approx(all_.rms, abs=0.01)
        assert some.holes == (1.0 if strength < 0.7 else 0.0)
        assert (
            0.5 * all_.spill < some.spill < 1.5 * all_.spill
        )  # the largest value seen, at other points


def test_unevenness_between_good_samples_is_found() -> None:
    """The samples are foci a wavelength apart, each exactly at its target."""
    session, samples, _ = solved(disc(0.0, 2.0, "disc"))
    kept = np.zeros(len(samples), dtype=np.bool_)
    for m in range(len(samples)):
        q = samples.positions[kept]
        kept[m] = not len(q) or np.linalg.norm(q - samples.positions[m], axis=1).min() > 0.008
    few = samples.only(kept)
    amplitudes = pc.sound_pressure(few.radiation_pressure, AIR)
    solution = session.solve(few.positions, amplitudes)
    asked = session.solve(few.positions, amplitudes, regions=few.regions)
    of = {"targets": asked.targets}
    found = measured(session, few, pc.Solution(**{**vars(solution), **of}), 50)["disc"]
    assert solution.error < 1e-2
    assert found.rms > 0.2
    assert not found.even


@pytest.mark.parametrize(
    ("name", "units"),
    [
        pytest.param("ball of 12 mm radius at a fingertip", 3, marks=pytest.mark.deep),
        ("letter S, at the palm", 3),
        ("ball of 10 mm radius at the palm", 1),
        ("edge of a box at a fingertip", 1),
    ],
)
def test_all_touched_skin_counts_in_the_report(name: str, units: int) -> None:
    """Between samples, half of the error was missing: it is at the rim, where the pressure falls to 0."""
    array, scene = pc.autd(units, units), CONTACTS[name]()
    with pc.Renderer(array, scene, medium=AIR, clock=ManualClock(), adaptive=False) as renderer:
        for k in range(600):
            renderer.tick(k * 1e-3)
        told = renderer.report.compute_felt()["object"]
        true = measure_felt(array, AIR, scene, 0.6, renderer.cycle_gains)
    assert true is not None
    assert told.force == pytest.approx(true.force, abs=0.05)
    assert told.rms == pytest.approx(true.rms, rel=0.2, abs=0.01)
    assert told.holes == pytest.approx(true.holes, abs=0.03)
    assert told.spill > 0.5 * true.spill


@pytest.mark.parametrize(
    "name", ["ball of 10 mm radius at the palm", "ball of 12 mm radius at a fingertip"]
)
def test_pressure_on_skin_beside_a_contact_is_not_overlooked(name: str) -> None:
    nine, scene = pc.autd(3, 3), CONTACTS[name]()
    with pc.Renderer(nine, scene, medium=AIR, clock=ManualClock(), adaptive=False) as renderer:
        for k in range(300):  # five measurements, each at other places
            renderer.tick(k * 1e-3)
        told = renderer.report.compute_felt()["object"].spill
        true = measure_felt(nine, AIR, scene, 0.3, renderer.cycle_gains)
    assert true is not None
    assert true.spill > 0.5
    assert told > 0.4 * true.spill


@pytest.mark.parametrize("count", [1, 2])
def test_regions_of_one_and_two_samples_are_looked_at(count: int) -> None:
    session = pc.Session(ARRAY, AIR)
    q = MIDDLE + np.array([[0.0, 0.0, 0.0], [0.002, 0.0, 0.0]])[:count]
    solution = session.solve(q, np.full(count, 500.0), regions=np.zeros(count, dtype=int))
    sampler = pc.Sampler()
    sampler.prepare(ARRAY, AIR)
    samples = sampler.sample(pc.Scene((disc(0.0, 1.0),))).only(np.arange(count))
    samples.positions[:] = q
    found = measured(session, samples, solution, 10)["surface 0"]
    assert found.force == pytest.approx(1.0, abs=0.05)


def test_points_have_none_and_the_report_has_each_object() -> None:
    point = pc.Point(position=(MIDDLE[0] + 0.03, MIDDLE[1], MIDDLE[2]), radiation_pressure=3.0)
    session, samples, solution = solved(point)
    assert (
        Probe(session).measure_between(samples, solution.targets, None, solution.gains[None]) == {}
    )
    scene = pc.Scene((point, disc(-0.01, 1.0, "disc")))
    with pc.Renderer(ARRAY, scene, clock=ManualClock()) as renderer:
        summary = renderer.run(2.0).summary()
    assert list(summary["felt"]) == ["disc"]
    felt = summary["felt"]["disc"]
    assert felt["force"] == pytest.approx(1.0, abs=0.05)
    assert felt["rms"] < 0.1
    assert felt["holes"] == 0.0
    assert renderer.report.compute_felt(5)["disc"].force == pytest.approx(1.0, abs=0.05)
    assert "felt of disc" in renderer.report._repr_html_()


def test_what_is_heard_is_that_of_a_new_probe_whatever_changed_since_the_last_call() -> None:
    """Arrays are also changed in place, like the loop's buffers."""
    session, samples, solution = solved(disc(0.0, 1.0))
    probe, rng = Probe(session), np.random.default_rng(3)
    points, gains = samples.positions.copy(), np.tile(solution.gains, (2, 1))
    normals = np.tile([0.0, 0.0, -1.0], (len(points), 1))

    def turn() -> None:
        normals[:] = rng.normal(size=normals.shape)
        normals[:] /= np.linalg.norm(normals, axis=1)[:, None]

    def move() -> None:
        points[0, 0] += 1e-3

    def dim() -> None:
        gains[1] *= np.float32(0.5)

    for faced in (False, True, False, True):
        for change in (turn, move, dim, lambda: None):
            change()
            facing = pc.SkinFacing(normals.copy()) if faced else None
            expected = Probe(session).compute_pressures(points, facing, gains)
            np.testing.assert_array_equal(probe.compute_pressures(points, facing, gains), expected)


def test_the_error_at_some_samples_is_that_at_all_on_average() -> None:
    """At all samples of a small disc, and at others each time of a larger one."""
    for radius in 0.004, 0.02:
        pose = pc.Pose(tuple(MIDDLE))
        session, samples, solution = solved(
            pc.Surface(shape=pc.Disc(radius), pose=pose, radiation_pressure=1.0)
        )
        gains = 0.9 * solution.gains[None]
        true = solution.targets.relative_error(0.9 * solution.sound_pressure)
        probe = Probe(session)
        found = [
            probe.estimate_error_at_samples(samples, solution.targets, gains) for _ in range(50)
        ]
        assert (len(samples) > SAMPLES) == bool(np.ptp(found) > 1e-9) == (radius > 0.01)
        assert np.sqrt(np.mean(np.square(found))) == pytest.approx(true, rel=0.02)


def test_a_measurement_that_fails_silences_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(*_: Any) -> Any:
        raise ZeroDivisionError

    monkeypatch.setattr(Probe, "measure_between", fail)
    for adaptive in (False, True):
        how = {"clock": ManualClock(), "adaptive": adaptive}
        with pc.Renderer(ARRAY, pc.Scene((disc(0.0, 1.0, "disc"),)), **how) as renderer:
            report = renderer.run(0.1)
            assert renderer.last_frame.amplitude.any()
        assert not report.fault_count
        assert report.skipped["measurements failed"]
        assert not report.compute_felt()


def test_what_is_measured_uneven_is_not_as_asked() -> None:
    """Two phases are too few for a disc, but every sample of the solution is right before it is rounded."""
    told = []
    for phases in (2, 256):
        device, how = Simulated(phases=phases), {"clock": ManualClock(), "adaptive": False}
        scene = pc.Scene((disc(0.0, 1.0, "disc"),))
        with pc.Renderer(ARRAY, scene, backend=device, **how) as renderer:
            told.append(renderer.run(0.2))
    coarse, fine = (report.deviations.totals.get("disc", {}) for report in told)
    assert coarse["measured uneven"].ticks >= 2
    assert not told[0].as_asked
    assert "measured uneven" not in fine


def test_what_a_point_presses_beside_a_contact_is_not_spill() -> None:
    four = pc.autd(2, 2)
    x, y = four.centre[:2].tolist()
    ball = pc.Volume(
        name="ball", shape=pc.Sphere(0.02), pose=pc.Pose((x, y, 0.163)), radiation_pressure=2.0
    )
    point = pc.Point(position=(x, y - 0.035, 0.18), force=4e-4)
    hand = pc.Hand.open("right", pc.Pose((x, y, 0.1955)))
    spills = []
    for items in ((ball,), (ball, point)):
        scene = pc.Scene(items, hands=(hand,))
        with pc.Renderer(four, scene, clock=ManualClock(), adaptive=False) as renderer:
            for k in range(400):
                renderer.tick(k * 1e-3)
            spills.append(renderer.report.compute_felt()["ball"].spill)
    assert spills[1] < 2.0 * spills[0]


def test_an_object_without_a_name_has_the_same_label_in_all_reports() -> None:
    device, how = Simulated(phases=2), {"clock": ManualClock(), "adaptive": False}
    with pc.Renderer(ARRAY, pc.Scene((disc(0.0, 1.0),)), backend=device, **how) as renderer:
        report = renderer.run(0.2)
    assert list(report.compute_felt()) == ["surface 0"]
    assert "measured uneven" in report.deviations.totals["surface 0"]


def test_frames_in_turn_that_rest_are_measured_some_times_only() -> None:
    plate = pc.Surface(
        shape=pc.Rectangle(0.08, 0.08), pose=pc.Pose(tuple(MIDDLE)), radiation_pressure=1.0
    )
    how = {"clock": ManualClock(), "adaptive": False}
    with pc.Renderer(ARRAY, pc.Scene((plate,)), **how) as renderer:
        for k in range(1500):
            renderer.tick(k * 1e-3)
        assert len(renderer.cycle_gains) > 1
        count = len(renderer.report.errors_at_samples)
        assert MAX_MEASUREMENTS_AT_REST <= count < 2 * MAX_MEASUREMENTS_AT_REST


def test_a_vibration_too_fast_for_each_of_two_frames_is_told() -> None:
    plate = pc.Surface(
        name="plate",
        shape=pc.Rectangle(0.08, 0.08),
        pose=pc.Pose(tuple(MIDDLE)),
        radiation_pressure=1.0,
        envelope=pc.Sine(300.0),
    )
    for rate, told in ((1000.0, True), (2000.0, False)):
        how = {"clock": ManualClock(), "adaptive": False, "backend": Simulated(rate=rate)}
        with pc.Renderer(ARRAY, pc.Scene((plate,)), **how) as renderer:
            for k in range(50):
                renderer.tick(k * 1e-3)
            assert len(renderer.cycle_gains) == 2
            assert ("too fast for the device" in renderer.report.deviations.totals["plate"]) is told
