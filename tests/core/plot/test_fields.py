"""Slices: the numbers in the picture are the field's, in double precision."""

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import pacinian as pc
from pacinian import plot

ARRAY = pc.autd()
AIR = pc.Air()
POINTS = np.array([[0.02, 0.0, 0.15], [-0.02, 0.01, 0.15]])
GAINS = pc.solve(ARRAY, POINTS, [300.0, 200.0], medium=AIR).gains


def drawn(page: Any) -> tuple[Any, Any]:
    """Return the values of the picture, (rows, columns), and their positions, (rows, columns, 2) [m]."""
    (image,) = (panel.images[0] for panel in page.axes if panel.images)
    found = np.ma.filled(image.get_array(), np.nan)
    left, right, bottom, top = image.get_extent()
    rows, columns = found.shape
    u = left + (np.arange(columns) + 0.5) / columns * (right - left)
    v = bottom + (np.arange(rows) + 0.5) / rows * (top - bottom)
    return found, 1e-3 * np.stack(np.meshgrid(u, v), axis=-1)


def heard(where: Any) -> Any:
    return pc.field(ARRAY, GAINS, where, AIR, "double")


@given(
    plane=st.sampled_from(["xy", "xz", "yz"]),
    at=st.tuples(*[st.floats(-0.05, 0.05)] * 2, st.floats(0.12, 0.2)),
    size=st.tuples(st.floats(0.02, 0.1), st.floats(0.02, 0.1)),
    show=st.sampled_from(["radiation", "pressure", "level", "phase"]),
)
@settings(max_examples=12, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_every_value_is_the_fields_where_the_axes_say(
    plane: str, at: Any, size: Any, show: Any
) -> None:
    found, where = drawn(plot.field(ARRAY, GAINS, plane, at, size=size, show=show, medium=AIR))
    q = np.broadcast_to(np.array(at), (*where.shape[:2], 3)).copy()
    for k in range(2):
        q[..., "xyz".index(plane[k])] = where[..., k]
    rows = np.linspace(0, len(q) - 1, 3).astype(int)
    p = heard(q[rows])
    if show == "phase":
        turn = np.exp(1j * found[rows]) * np.exp(-1j * np.angle(p))
        loud = np.abs(p) > 0.02 * np.abs(p).max()
        np.testing.assert_allclose(turn[loud], 1.0, atol=0.02)
        return
    exact = {
        "radiation": pc.radiation_pressure(p, AIR),
        "pressure": np.abs(p),
        "level": pc.sound_pressure_level(p),
    }[show]
    loud = np.abs(p) > 0.05 * np.abs(p).max()
    np.testing.assert_allclose(found[rows][loud], exact[loud], rtol=5e-3)


def test_a_pose_is_a_plane_of_its_own() -> None:
    pose = pc.Pose((0.01, 0.0, 0.15)).rotate("y", math.radians(30.0))
    page = plot.field(ARRAY, GAINS, pose, size=(0.1, 0.05), medium=AIR)
    found, where = (part[::20] for part in drawn(page))
    local = np.concatenate([where, np.zeros((*where.shape[:2], 1))], axis=-1)
    P = pc.radiation_pressure(heard(pose.points(local)), AIR)
    np.testing.assert_allclose(found, P, atol=2e-3 * P.max())
    assert page.axes[0].get_xlabel() == "u [mm]"


def test_several_moments_are_shown_by_their_mean_power() -> None:
    other = pc.solve(ARRAY, POINTS[:1], [250.0], medium=AIR).gains
    both = np.stack([GAINS, other])
    one, two, mean = (
        drawn(plot.field(ARRAY, g, "xy", POINTS[0], medium=pc.Air()))[0]
        for g in (GAINS, other, both)
    )
    np.testing.assert_allclose(mean, (one + two) / 2.0, rtol=1e-5, atol=1e-6)
    p1, p2, rms = (
        drawn(plot.field(ARRAY, g, "xy", POINTS[0], show="pressure", medium=pc.Air()))[0]
        for g in (GAINS, other, both)
    )
    np.testing.assert_allclose(rms, np.sqrt((p1**2 + p2**2) / 2.0), rtol=1e-5)


def test_only_near_points_are_marked() -> None:
    far = np.array([[0.0, 0.0, 0.15], [0.0, 0.05, 0.15]])
    page = plot.field(ARRAY, GAINS, "xz", (0.0, 0.0, 0.15), points=far, size=0.1, medium=pc.Air())
    (marks,) = page.axes[0].lines
    np.testing.assert_allclose(marks.get_xydata(), [[0.0, 150.0]], atol=1e-9)


def test_a_plane_through_the_transducers_has_holes_and_dims_nothing() -> None:
    array = pc.lattice(0.1, 0.1)
    g = pc.solve(array, [[0.0, 0.0, 0.1]], [20.0]).gains
    page = plot.field(array, g, "xz", (0.0, 0.0, 0.05), size=0.1, show="pressure", medium=pc.Air())
    found, where = drawn(page)
    (image,) = page.axes[0].images
    low, high = image.get_clim()
    assert low == 0.0
    away = where[..., 1] > 0.009
    assert high == pytest.approx(found[away].max(), rel=0.05)
    flat = plot.field(array, g, "xy", (0.0, 0.0, 0.0), size=0.1, medium=pc.Air())
    assert np.isfinite(flat.axes[0].images[0].get_clim()).all()


def test_what_is_silent_is_dark_and_not_missing() -> None:
    page = plot.field(ARRAY, GAINS, "xz", (0.0, 0.0, 0.0), size=0.1, show="level", medium=pc.Air())
    found, where = drawn(page)
    behind = where[..., 1] < -0.01
    np.testing.assert_array_equal(found[behind], page.axes[0].images[0].get_clim()[0])
    nothing = plot.field(ARRAY, np.zeros(len(ARRAY)), "xy", show="level", medium=pc.Air())
    assert np.isfinite(drawn(nothing)[0]).all()


def test_without_points_the_slice_is_before_the_array_wherever_it_faces() -> None:
    down = ARRAY.transform(pc.Pose((0.0, 0.0, 0.5)).rotate("x", math.pi))
    found = plot.field(down, GAINS, "xy", medium=pc.Air()).axes[0].get_title()
    assert found == "z = 300 mm"


@pytest.mark.parametrize("plane", ["xy", "xz"])
def test_every_axis_has_its_unit(plane: str) -> None:
    for show, unit in (
        ("radiation", "[Pa]"),
        ("pressure", "[Pa]"),
        ("level", "[dB"),
        ("phase", "[rad]"),
    ):
        (panel,) = plot.field(ARRAY, GAINS, plane, POINTS[0], show=show, medium=pc.Air()).axes  # type: ignore[arg-type]
        (bar,) = panel.child_axes
        assert panel.get_xlabel().endswith("[mm]")
        assert panel.get_ylabel().endswith("[mm]")
        assert unit in bar.get_ylabel() + bar.get_xlabel()


def test_a_bar_is_as_high_as_its_panel_and_tells_of_values_beyond_its_end() -> None:
    array = pc.lattice(0.1, 0.1)
    near = plot.field(array, np.ones(len(array)), "xz", (0.0, 0.0, 0.05), size=0.1, medium=pc.Air())
    for page, extend in (
        (near, "max"),
        (plot.field(ARRAY, GAINS, points=POINTS, medium=pc.Air()), "neither"),
    ):
        page.draw_without_rendering()
        (panel,) = page.axes
        (bar,) = panel.child_axes
        assert bar._colorbar.extend == extend
        box, beside = panel.get_window_extent(), bar.get_window_extent()
        arrow = 0.0 if extend == "neither" else 0.05 * box.height
        assert (beside.y0, beside.y1) == pytest.approx((box.y0, box.y1 - arrow), abs=1.0)


def test_the_place_of_a_plane_is_not_rounded_away() -> None:
    page = plot.field(ARRAY, GAINS, "xy", (0.0, 0.0, 0.1025), size=0.1, medium=pc.Air())
    assert page.axes[0].get_title() == "z = 102.5 mm"


def test_samples_away_from_the_horizontal_slice_are_told_apart() -> None:
    points = [[0.0, 0.0, 0.2], [0.01, 0.0, 0.2], [0.02, 0.0, 0.24]]
    horizontal = plot.slices(ARRAY, GAINS, points, medium=pc.Air()).axes[0]
    counts = {line.get_label(): len(line.get_xdata()) for line in horizontal.lines}
    assert counts == {"samples": 0, "samples more than 12 mm away": 3}
    flat = plot.slices(ARRAY, GAINS, points[:2], medium=pc.Air()).axes[0]
    assert [line.get_label() for line in flat.lines] == ["samples"]


def test_slices_take_lists() -> None:
    assert len(plot.slices(ARRAY, GAINS, POINTS.tolist(), medium=pc.Air()).axes) == 3


def test_a_slice_holds_all_points_and_is_no_larger_for_those_beside_it() -> None:
    points = np.array([[0.03, 0.09, 0.15], [-0.03, -0.09, 0.16]])
    flat = plot.field(ARRAY, GAINS, "xz", points=points, medium=pc.Air()).axes[0]
    np.testing.assert_allclose(flat.get_xlim(), (-60.0, 60.0), atol=0.5)
    tilted = pc.Pose((0.0, 0.02, 0.155)).rotate("z", math.pi / 2.0)
    turned = plot.field(ARRAY, GAINS, tilted, points=points, medium=pc.Air()).axes[0]
    np.testing.assert_allclose(turned.get_xlim(), (-140.0, 140.0), atol=1.0)
