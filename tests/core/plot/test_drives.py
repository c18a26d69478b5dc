"""Plots of drives: each disc has its transducer's position and value."""

import math
from typing import Any

import numpy as np
import pytest

import pacinian as pc
from pacinian import plot

ARRAY = pc.autd()
GAINS = pc.solve(ARRAY, [[0.02, 0.0, 0.15]], [300.0]).gains.copy()
GAINS[:20] *= np.linspace(0.1, 0.9, 20).astype(np.float32)
GAINS[-5:] = 0.0


def discs(panel: Any) -> tuple[Any, Any]:
    """Return positions (N, 2) [m] and values (N,)."""
    (made,) = panel.collections
    return 1e-3 * np.asarray(made.get_offsets()), made.get_array()


def test_phases_and_amplitudes_are_shown_where_they_are() -> None:
    page = plot.drive(ARRAY, GAINS)
    phase, amplitude = page.axes
    bars = [*phase.child_axes, *amplitude.child_axes]
    for panel, exact in ((phase, np.angle(GAINS)), (amplitude, np.abs(GAINS))):
        r, shown = discs(panel)
        np.testing.assert_allclose(r, ARRAY.positions[:, :2], atol=1e-12)
        np.testing.assert_allclose(np.ma.getdata(shown), exact, atol=1e-6)
    assert [bar.get_ylabel() for bar in bars] == ["phase [rad]", "amplitude |g| (1: full drive)"]


def test_a_silent_transducer_has_no_phase() -> None:
    _, shown = discs(plot.drive(ARRAY, GAINS, "phase").axes[0])
    np.testing.assert_array_equal(np.ma.getmaskarray(shown), GAINS == 0.0)
    plot.drive(ARRAY, np.zeros(len(ARRAY)))


def test_phases_meet_where_they_are_the_same() -> None:
    (made,) = plot.drive(ARRAY, GAINS, "phase").axes[0].collections
    assert made.get_clim() == (-np.pi, np.pi)
    first, last = made.cmap([0.0, 1.0])[:, :3]
    np.testing.assert_allclose(first, last, atol=0.02)


@pytest.mark.parametrize(
    ("axis", "names"), [("x", ("x", "z")), ("y", ("y", "z")), ("z", ("x", "y"))]
)
def test_an_array_is_seen_along_what_it_faces(axis: str, names: tuple[str, str]) -> None:
    pose = pc.Pose().rotate(axis, math.pi / 2.0)
    moved = ARRAY.transform(pose)
    panel = plot.drive(moved, GAINS, "phase").axes[0]
    assert (panel.get_xlabel(), panel.get_ylabel()) == (f"{names[0]} [mm]", f"{names[1]} [mm]")
    r, _ = discs(panel)
    columns = ["xyz".index(name) for name in names]
    seen = {tuple(row) for row in np.round(r, 6)}
    assert seen == {tuple(row) for row in np.round(moved.positions[:, columns], 6)}


def test_the_nearest_to_the_viewer_is_drawn_last() -> None:
    stack = pc.Array([[0.0, 0.0, 0.01], [0.0, 0.0, 0.0]])
    _, shown = discs(plot.drive(stack, [1.0, 0.5], "amplitude").axes[0])
    assert list(shown) == [0.5, 1.0]


def test_one_transducer_can_be_drawn() -> None:
    plot.drive(pc.Array([[0.0, 0.0, 0.0]]), [1.0])
