"""`Report.as_asked`: a good contact at rest has it, and each loss that skin could feel is named, and no other."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import pacinian as pc
from pacinian.rendering.frame_deviations import FrameDeviations, describe_solve
from pacinian.rendering.sample_solver import MISSED_BELOW
from pacinian.rendering.weak_samples import count_weak_samples
from pacinian.solving.felt_figures import FeltRegion, FeltSums
from pacinian.testing import ManualClock
from pacinian_lab.regions.contacts import CONTACTS
from pacinian_plugins.backends.simulated import Simulated

if TYPE_CHECKING:
    from pacinian.rendering.solution_sequence import SolveResult

AIR, ONE, FOUR, NINE = pc.Air(), pc.autd(), pc.autd(2, 2), pc.autd(3, 3)
TICK = 1e-3  # [s]
HAND = pc.Hand.open("right", pc.Pose((0.0, 0.0, 0.21)))
WEAKER, FAINT = "weaker than asked", "too faint to feel"


def press(
    radius: float, depth: float, x: float = 0.0, y: float = 0.0, pressure: float = 6.0
) -> pc.Scene:
    """Return an open hand whose skin at x, y has sunk `depth` into a ball from above [m]."""
    z = 0.2045 if y > 0.05 else 0.195  # height of the skin: of a fingertip, or of the palm
    ball = pc.Volume(
        name="object",
        shape=pc.Sphere(radius),
        pose=pc.Pose((x, y, z - radius + depth)),
        radiation_pressure=pressure,
    )
    return pc.Scene((ball,), hands=(HAND,))


def render(scene: pc.Scene, array: pc.Array = NINE, ticks: int = 40, **options: Any) -> pc.Renderer:
    how: dict[str, Any] = {"medium": AIR, "clock": ManualClock(), "adaptive": False} | options
    with pc.Renderer(array, scene, **how) as renderer:
        for k in range(ticks):
            renderer.tick(k * TICK)
    assert not renderer.report.fault_count
    return renderer


def evaluate(scene: pc.Scene, renderer: pc.Renderer, height: float = np.inf) -> FeltRegion:
    """Return what is felt at some points of the touched skin, from a field of double precision.

    height: of the ramp, above which nothing is asked for yet [Pa].
    """
    array = renderer.session.array
    fine = pc.Sampler(10**6, 1e-3, perception=False)
    fine.prepare(array, AIR)
    full = fine.sample(scene)
    some = np.random.default_rng(0).permutation(np.flatnonzero(full.regions >= 0))[:100]
    full = full.only(some)
    assert full.capsules is not None
    facing = pc.SkinFacing(full.normals, full.capsules)
    P = np.mean(
        [pc.normal_pressure(array, g, full.positions, facing, AIR) for g in renderer.cycle_gains],
        axis=0,
    )
    asked, area = np.minimum(full.radiation_pressure, height), full.area
    return FeltRegion(
        force=float(P @ area / (asked @ area)),
        rms=float(np.sqrt((P - asked) ** 2 @ area / (asked**2 @ area))),
        holes=float(area[asked > 2.0 * P].sum() / area.sum()),
    )


def reasons(renderer: pc.Renderer) -> set[str]:
    return set(renderer.report.deviations.totals.get("object", ()))


GOOD = {
    "ball of 17 mm radius at the palm": lambda: press(0.017, 0.0025, 0.004, 0.006),
    "ball of 13.5 mm radius at the palm": lambda: press(0.0135, 0.003, 0.004, 0.006),
    "ball of 14 mm radius at a fingertip": lambda: press(0.014, 0.003, 0.0005, 0.085),
    "ball of 30 mm radius at the palm": CONTACTS["ball of 30 mm radius at the palm"],
    "ball of 10 mm radius at the palm": CONTACTS["ball of 10 mm radius at the palm"],
    "disc at the palm": CONTACTS["disc, 30 mm, at the palm"],
    "strip at the palm": CONTACTS["strip, 8 x 30 mm, at the palm"],
}


LARGE_OR_SMALL = {"ball of 30 mm radius at the palm", "ball of 10 mm radius at the palm"}


@pytest.mark.parametrize(
    "name",
    [pytest.param(one, marks=[pytest.mark.deep] if one in LARGE_OR_SMALL else []) for one in GOOD],
)
def test_a_good_contact_at_rest_is_as_asked_and_its_figures_are_true(name: str) -> None:
    """A short run is measured after the ramps."""
    scene = GOOD[name]()
    renderer = render(scene)
    report, told = renderer.report, renderer.report.compute_felt()["object"]
    true = evaluate(scene, renderer)
    assert true.even  # or this contact is no example of a good one
    assert report.as_asked, report.deviations.totals
    assert told.force == pytest.approx(true.force, abs=0.05)
    assert told.rms == pytest.approx(true.rms, abs=0.03)
    assert set(renderer.sample_counts["object"].reasons) <= {FAINT}  # which nobody feels


def zone_at(x: float, y: float, z: float) -> pc.Limits:
    return pc.Limits(zones=(pc.Zone((x, y, z), pressure=30.0, radius=0.008),))


BAD: dict[str, tuple[Any, pc.Array, dict[str, Any]]] = {
    "one unit, palm": (lambda: press(0.017, 0.0025, 0.004, 0.006), ONE, {}),
    "one unit, fingertip": (CONTACTS["ball of 12 mm radius at a fingertip"], ONE, {}),
    "edge of a box": (CONTACTS["edge of a box at a fingertip"], NINE, {}),
    "edge of a box, one unit": (CONTACTS["edge of a box at a fingertip"], ONE, {}),
    "two phases": (GOOD["disc at the palm"], NINE, {"backend": Simulated(phases=2)}),
    "zone": (GOOD["disc at the palm"], FOUR, {"limits": zone_at(0.012, 0.0, 0.195)}),
    "coarsened": (GOOD["disc at the palm"], NINE, {"sampler": pc.Sampler(40, ramp=0.005)}),
}


def test_the_array_that_a_zone_disturbs_is_large_enough_without_it() -> None:
    assert render(GOOD["disc at the palm"](), FOUR, ticks=20).report.as_asked


@pytest.mark.parametrize("name", list(BAD))
def test_a_contact_that_is_clearly_uneven_or_weak_is_not_as_asked(name: str) -> None:
    make, array, how = BAD[name]
    scene = make()
    renderer = render(scene, array, ticks=20, **how)
    true = evaluate(scene, renderer)
    assert name == "coarsened" or not true.even  # the sampler left out most of the samples
    assert not renderer.report.as_asked
    assert reasons(renderer)


@pytest.mark.parametrize("pressure", [0.1, 0.3, 1.0])
def test_only_an_object_that_is_too_faint_as_a_whole_is_named(pressure: float) -> None:
    """At 0.3 Pa, only the deepest skin is pressed with the 0.22 Pa that can be felt."""
    renderer = render(press(0.017, 0.0025, 0.004, 0.006, pressure), ticks=20)
    counts = renderer.sample_counts.get("object")
    assert counts is not None
    assert counts.reasons[FAINT] > 0
    assert renderer.report.skipped["samples too faint to feel"] > 0
    assert (FAINT in reasons(renderer)) == (pressure < 1.0)
    assert renderer.report.as_asked == (pressure == 1.0)
    assert bool(counts.rendered) == (pressure > 0.1)


@pytest.fixture(scope="module")
def played() -> SolveResult:
    """A solution for a disc in free air and a point beside it, which all get nearly what they ask for."""
    x, y = ONE.centre[:2].tolist()
    disc = pc.Surface(
        name="object",
        shape=pc.Disc(0.015),
        pose=pc.Pose((x - 0.02, y, 0.2)),
        radiation_pressure=1.0,
    )
    point = pc.Point(name="point", position=(x + 0.03, y, 0.2), radiation_pressure=1.0)
    return render(pc.Scene((disc, point)), ONE, ticks=12)._pipeline.played


def weaken(
    result: SolveResult, share: np.ndarray[Any, Any]
) -> tuple[SolveResult, dict[str, list[float]]]:
    """Return the result as if each sample got this share of its target, (M,). Also the shares by object."""
    (one,) = result.solutions.rows
    assert one.samples is one.all_samples
    p = one.solution.targets.amplitudes * np.sqrt(share)
    solution = pc.Solution(**{**vars(one.solution), "sound_pressure": p.astype(np.complex128)})
    missed = tuple(np.flatnonzero(share < MISSED_BELOW).tolist())
    rows = (replace(one, solution=solution, missed=missed),)
    samples = one.samples
    told = {item.name: share[samples.objects == i].tolist() for i, item in enumerate(samples.items)}
    solutions = replace(result.solutions, rows=rows)
    weak = count_weak_samples(solutions, ())
    deviations = describe_solve(result.sample_counts, (), weak)
    return result._replace(solutions=solutions, deviations=deviations), told


def describe(result: SolveResult) -> Any:
    return FrameDeviations().describe(
        result, result, between=False, held_back=False, silenced=False
    )


@settings(max_examples=40, deadline=None)
@given(st.floats(0.0, 0.5), st.floats(0.0, 0.89), st.floats(1.0, 1.6), st.randoms())
def test_a_part_that_is_missing_is_named_even_if_the_rest_makes_up_for_its_force(
    played: SolveResult, part: float, left: float, rest: float, chance: Any
) -> None:
    """The samples of a disc represent equal areas, roughly, so shares of samples are shares of the force."""
    (one,) = played.solutions.rows
    disc = np.flatnonzero(one.samples.objects == 0).tolist()
    some = chance.sample(disc, round(part * len(disc)))
    share = np.full(len(one.samples), rest)
    share[some] = left
    area = one.samples.area
    lost = float((1.0 - left) * area[some].sum() / area[disc].sum())
    found = describe(weaken(played, share)[0])
    assert "point" not in found
    if lost > 0.02 or (some and left < 0.5):
        assert found["object"] == {WEAKER: len(some)}
    if not some or (lost < 0.01 and left > 0.5):
        assert "object" not in found


def test_a_whole_that_is_too_weak_is_named_though_no_sample_is_much_too_weak(
    played: SolveResult,
) -> None:
    count = len(played.solutions.rows[0].samples)
    for share, named in ((0.98, False), (0.96, True), (0.92, True)):
        found = describe(weaken(played, np.full(count, share))[0])
        assert (WEAKER in found.get("object", {})) is named
        assert "point" not in found  # a single sample has the limit that it always had


def test_each_point_that_is_too_weak_is_named(played: SolveResult) -> None:
    objects = played.solutions.rows[0].samples.objects
    for share in (0.95, 0.85, 0.1):
        found = describe(weaken(played, np.where(objects == 1, share, 1.0))[0])
        assert found == ({"point": {WEAKER: 1}} if share < MISSED_BELOW else {})


@pytest.mark.parametrize("ramp", [0.0, 0.005, 0.02])
def test_the_first_measurement_does_not_depend_on_the_ramp(ramp: float) -> None:
    scene = press(0.017, 0.0025, 0.004, 0.006)
    report = render(scene, sampler=pc.Sampler(ramp=ramp), ticks=20 + round(ramp / TICK)).report
    told = report.compute_felt()["object"]
    assert len(report.errors_at_samples) == 1
    assert told.force == pytest.approx(1.0, abs=0.05)
    assert told.rms < 0.07


def test_a_measurement_during_a_ramp_compares_with_the_pressures_of_that_time() -> None:
    """The ramp is too long to wait for its end. Its pressures are those asked for, up to the height of the ramp."""
    scene = press(0.017, 0.0025, 0.004, 0.006)
    how: dict[str, Any] = {"medium": AIR, "clock": ManualClock(), "adaptive": False}
    with pc.Renderer(NINE, scene, sampler=pc.Sampler(ramp=0.2), **how) as renderer:
        for k in range(120):
            renderer.tick(k * TICK)
            if len(renderer.report.errors_at_samples):
                break
        assert renderer.samples is not None
        height = renderer.samples.radiation_pressure.max()
        true = evaluate(scene, renderer, height)
    told = renderer.report.compute_felt()["object"]
    assert 0.05 < height / 6.0 < 0.7
    assert told.force == pytest.approx(true.force, abs=0.05)
    assert told.rms == pytest.approx(true.rms, abs=0.05)


def test_frames_in_turn_are_measured_when_all_are_solved_for_the_full_pressures() -> None:
    plate = pc.Surface(
        name="object",
        shape=pc.Rectangle(0.08, 0.08),
        pose=pc.Pose((*NINE.centre[:2].tolist(), 0.2)),
        radiation_pressure=1.0,
    )
    renderer = render(pc.Scene((plate,)), sampler=pc.Sampler(80, ramp=0.005))
    assert len(renderer.cycle_gains) == 2
    assert renderer.report.compute_felt()["object"].force == pytest.approx(1.0, abs=0.08)


def test_texts_say_that_the_error_is_that_at_the_samples() -> None:
    report = render(press(0.017, 0.0025), ticks=20).report
    assert f"error at samples {report.error_at_samples:.2%}" in str(report)
    assert "error at samples" in str(report._repr_html_())


@pytest.mark.parametrize("on_skin", [True, False])
@pytest.mark.parametrize("spill", [1.9, 2.1])
def test_what_presses_much_on_skin_beside_is_named(spill: float, on_skin: bool) -> None:
    """In free air, nobody feels it."""
    sums = FeltSums(asked=20.0, made=20.0, squares=20.0, places=20, beside=spill)
    report = pc.Report()
    report.add_measurement(0.0, {"a": sums}, {"a"} if on_skin else ())
    report.count_tick(0.0, late=False)
    report.count_tick(0.0, late=False)
    named = report.deviations.totals.get("a", {})
    assert sorted(named) == ["pressed beside"] * (spill > 2.0 and on_skin)
    assert all(total.ticks == 1 for total in named.values())


def test_parts_of_a_mask_without_pressure_do_not_count_in_two_frames() -> None:
    """A spiral that is too fine for samples at its outline: samples between its arms ask for nothing."""
    y, x = np.mgrid[-1.0:1.0:64j, -1.0:1.0:64j]
    radius, turn = np.hypot(x, y), np.arctan2(y, x) / (2.0 * np.pi)
    mask = ((2.2 * radius - turn) % 1.0 < 0.45) & (radius < 1.0)
    surface = pc.Surface(
        name="object",
        shape=pc.Rectangle(0.045, 0.045),
        pose=pc.Pose((*NINE.centre[:2].tolist(), 0.2)),
        texture=pc.Texture(values=mask.astype(float), size=(0.045, 0.045), repeat=False),
        radiation_pressure=11.0,
    )
    renderer = render(pc.Scene((surface,)), ticks=30)
    assert renderer.played.cycle
    assert renderer.samples is not None
    assert (renderer.samples.radiation_pressure > 0.0).all()
    assert renderer.report.compute_felt()["object"].force == pytest.approx(1.0, abs=0.15)
