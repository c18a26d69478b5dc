"""Measures, against closed forms, direct evaluation and the paper's own experiment."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import pacinian as pc
from pacinian.devices.description import LevelCounts, TransducerType
from pacinian.testing import ManualClock
from pacinian_lab.study import worker
from pacinian_lab.study.layouts import Autd, Lattice, Rings
from pacinian_lab.study.measures import MEASURES, amplitudes, compute_emitted_power, image
from pacinian_lab.study.patterns import Focus, Points, RandomPoints
from pacinian_lab.study.planes import Plane
from pacinian_lab.study.study_file import Picture, Study, read
from pacinian_lab.study.tasks import Plan
from pacinian_lab.study.worker import measure, quantise_gains, solve, targets

AIR = pc.Air()
STUDIES = Path(__file__).parents[3] / "examples" / "studies"
SMALL = Picture(side=0.12, step=0.004)
values = st.floats(0.1, 10.0)


def rows(**parts: object) -> list[dict]:
    defaults = {"layouts": (Lattice(width=0.1),), "patterns": (Focus(),), "picture": SMALL}
    plan = Plan(Study(**{**defaults, **parts}))
    return [row for batch in plan.batches() for row in measure(plan.batch(batch))]


@given(t=st.lists(values, min_size=2, max_size=9), c=values)
def test_a_multiple_of_what_is_asked_has_no_shape_error(t: list[float], c: float) -> None:
    asked = np.array(t)
    found = amplitudes(c * asked, asked, exact=True)
    assert found["error"] == pytest.approx(abs(c - 1.0), abs=1e-12)
    assert found["shape_error"] == pytest.approx(0.0, abs=1e-12)
    assert found["scale"] == pytest.approx(c)
    assert found["maximum"] == c * max(t)
    if np.ptp(asked) > 1e-3:
        assert found["correlation"] == pytest.approx(1.0)


def test_errors_of_known_amplitudes() -> None:
    found = amplitudes(np.array([3.0, 0.0]), np.array([0.0, 4.0]), exact=True)
    assert found["error"] == pytest.approx(5.0 / 4.0)
    assert math.isnan(found["shape_error"])  # no multiple of it is near
    assert found["correlation"] == pytest.approx(-1.0)
    found = amplitudes(np.array([1.0, 1.0]), np.array([1.0, 1.0]), exact=False)
    assert math.isnan(found["error"])
    assert math.isnan(found["scale"])
    assert math.isnan(found["correlation"])  # nothing varies


def test_an_image_of_known_powers() -> None:
    field = np.array([[2.0, 1.0], [math.nan, 1.0]])
    lobes = np.array([[True, False], [True, False]])
    found = image(np.array([2.0]), field, lobes)
    assert found["efficiency"] == pytest.approx(4.0 / 6.0)
    assert found["side_lobe"] == pytest.approx(20.0 * math.log10(1.0 / 2.0))
    assert found["contrast"] == pytest.approx((4.0 - 1.0) / (4.0 + 1.0))
    for dead in (image(np.zeros(1), 0.0 * field, lobes), image(np.ones(1), field, lobes | True)):
        assert all(map(math.isnan, dead.values()))


@pytest.mark.parametrize("kind", [pc.IDEAL, pc.T4010A1])
def test_emitted_power_is_what_flows_through_a_sphere(kind: pc.Transducer) -> None:
    array, R = pc.Array([[0.0, 0.0, 0.0]], transducer=kind), 1.0
    cosine, weight = np.polynomial.legendre.leggauss(400)
    ring = np.column_stack([np.sqrt(1.0 - cosine**2), 0.0 * cosine, cosine])
    flow = (pc.intensity(array, [0.5], R * ring, AIR) * ring).sum(axis=1)
    through = 2.0 * math.pi * R**2 * float(weight @ flow)
    assert compute_emitted_power(array, np.array([0.5 + 0j]), AIR) == pytest.approx(
        through, rel=2e-3
    )


def test_there_is_no_power_where_sound_does_not_fade() -> None:
    array = pc.Array([[0.0, 0.0, 0.0]])
    assert math.isnan(compute_emitted_power(array, np.ones(1, complex), pc.Air(attenuation="none")))


def test_the_yield_of_one_transducer_is_a_closed_form() -> None:
    r = 0.1
    (row,) = rows(
        layouts=(Rings(diameter=0.001),),
        planes=(Plane(z=r),),
        transducer=TransducerType(directivity="omni"),
    )
    assert row["transducers"] == 1
    c = AIR.speed_of_sound
    assert row["yield"] == pytest.approx(1.0 / (2.0 * math.pi * c * r**2), rel=1e-5)


def test_everything_agrees_with_direct_evaluation_in_double_precision() -> None:
    study = Study(
        layouts=(Lattice(width=0.1),), patterns=(RandomPoints(count=4, side=0.08),),
        planes=(Plane(z=0.15, tilt=0.5, azimuth=0.35),), picture=SMALL, levels=(0.4,),
    )  # fmt: skip
    plan = Plan(study)
    batch = plan.batch(plan.tasks)
    (row,) = measure(batch)
    target_plane = batch.target_plane()
    g = solve(batch, target_plane, batch.jobs[0]).gains
    B = pc.matrix(batch.array, target_plane.points, AIR)
    t = targets(batch, target_plane, 0.4)
    assert np.linalg.norm(t) == pytest.approx(0.4 * np.abs(B).sum(axis=1).mean())
    a = np.abs(pc.field(batch.array, g, target_plane.points, AIR, precision="double"))
    assert row["error"] == pytest.approx(np.linalg.norm(a - t) / np.linalg.norm(t), abs=1e-7)
    assert row["maximum"] == pytest.approx(a.max(), rel=1e-6)
    assert row["condition"] == pytest.approx(np.linalg.cond(B), rel=1e-9)
    assert row["rank"] == np.linalg.matrix_rank(B)
    foci = [
        pc.solve(batch.array, [q], [1.0], solver="single-focus", scale="max")
        for q in target_plane.points
    ]
    reached = max(float(np.abs(focus.sound_pressure[0])) for focus in foci)
    assert row["reach"] == pytest.approx(reached, rel=1e-5)
    pixels = Plane(z=0.15, tilt=0.5, azimuth=0.35).points(target_plane.pixels)
    P = np.abs(pc.field(batch.array, g, pixels, AIR, precision="double")) ** 2
    assert pixels.shape == (31, 31, 3)
    assert row["efficiency"] == pytest.approx(P[target_plane.lobes].sum() / P.sum(), rel=1e-4)
    outside = P[~target_plane.lobes]
    loudest = max(P[target_plane.lobes].max(), (a**2).max())
    assert row["side_lobe"] == pytest.approx(10.0 * np.log10(outside.max() / loudest), abs=1e-3)
    within = (a**2).mean()
    assert row["contrast"] == pytest.approx(
        (within - outside.mean()) / (within + outside.mean()), rel=1e-4
    )


def test_pixels_at_a_transducer_do_not_count() -> None:
    study = Study(
        layouts=(Lattice(width=0.1),), patterns=(Focus(),), picture=SMALL,
        planes=(Plane(z=0.05, tilt=np.pi / 2.0),),
    )  # fmt: skip
    plan = Plan(study)
    target_plane = plan.batch(plan.tasks).target_plane()
    field = target_plane.field(np.ones(121))
    near = np.linalg.norm(
        target_plane.plane.points(target_plane.pixels)[:, :, None] - target_plane.array.positions,
        axis=-1,
    )
    assert np.array_equal(np.isnan(field), near.min(axis=-1) < 0.00425)
    assert np.isnan(field).any()


@pytest.mark.parametrize(
    ("case", "form", "correlation", "maximum", "rank", "condition"),
    [("1a", "ring", "0.82", "1.06", 861, "75"), ("2b", "cross", "0.61", "0.91", 451, "inf")],
)  # fmt: skip
def test_the_papers_experiment_comes_out_as_it_does_elsewhere(
    case: str, form: str, correlation: str, maximum: str, rank: int, condition: str
) -> None:
    plan = Plan(read(STUDIES / "paper.toml"))
    place = {"layout": case[1], "plane": case[0], "pattern": f"shape form={form}"}
    (task,) = [t for t in plan.tasks if {k: getattr(t.place, k).label for k in place} == place]
    batch = replace(plan.batch([task]), picture=Picture(side=0.4, step=0.05))
    (row,) = measure(batch)
    asked = float(targets(batch, batch.target_plane(), 1.0).max())
    assert f"{row['correlation']:.2f}" == correlation
    assert f"{row['maximum'] / asked:.2f}" == maximum
    assert row["rank"] == rank
    assert f"{row['condition']:.0f}" == condition


def test_gains_are_rounded_to_the_devices_levels_before_they_are_judged() -> None:
    parts = {"patterns": (RandomPoints(count=3, side=0.08),)}
    (exact,) = rows(**parts)
    (coarse,) = rows(**parts, emitted=LevelCounts(phases=8, amplitudes=8))
    assert coarse["error"] > 10.0 * exact["error"]
    study = Study(
        layouts=(Autd(),), picture=SMALL, emitted=LevelCounts(phases=16, amplitudes=5), **parts
    )
    batch = Plan(study).batch(Plan(study).tasks)
    g = quantise_gains(batch, solve(batch, batch.target_plane(), batch.jobs[0]).gains)
    np.testing.assert_allclose(4.0 * np.abs(g), np.rint(4.0 * np.abs(g)), atol=1e-5)
    turns = 16.0 * np.angle(g[np.abs(g) > 0.0]) / (2.0 * np.pi)
    np.testing.assert_allclose(turns, np.rint(turns), atol=1e-4)


def test_the_strongest_reaches_what_is_said_to_be_reachable() -> None:
    (row,) = rows(levels=(math.inf,))
    assert row["maximum"] == pytest.approx(row["reach"], rel=1e-5)
    assert math.isnan(row["error"])
    (half,) = rows(levels=(math.inf,), gain=0.5)
    assert half["reach"] == pytest.approx(row["reach"] / 2.0)
    assert half["maximum"] == pytest.approx(row["maximum"] / 2.0, rel=1e-5)


def test_what_fails_is_a_row_with_its_reason_beside_those_that_do_not() -> None:
    places = (Plane(z=0.1), Plane(name="in the array", z=0.0), Plane(name="behind it", z=-0.1))
    good, bad, unheard = rows(planes=places)
    assert good["failure"] is None
    assert bad["failure"].startswith("PointOnTransducer: ")
    assert "cannot be reached by the sound of any transducer" in unheard["failure"]
    assert set(bad) == {"key", "failure"}


def test_the_run_time_is_that_of_the_solver_over_that_of_the_reference(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    clock = ManualClock()

    def solved(*given: Any) -> pc.Solution:
        clock.advance(0.75)
        return solve(*given)

    monkeypatch.setattr(worker, "time", SimpleNamespace(perf_counter=clock.now))
    monkeypatch.setattr(worker, "solve", solved)
    monkeypatch.setattr(worker, "_reference", lambda: 0.25)
    (row,) = rows()
    assert (row["seconds"], row["run_time"]) == (0.75, 3.0)


def test_every_measure_is_measured() -> None:
    (row,) = rows(patterns=(Points(points=((0.0, 0.0), (0.02, 0.0)), proportions=(1.0, 0.5)),))
    assert row.keys() >= MEASURES.keys()
    assert all(math.isfinite(row[name]) for name in MEASURES)
