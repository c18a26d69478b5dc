"""All plots name a bad argument, and draw into the caller's axes."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import pacinian as pc
from pacinian import plot

ARRAY = pc.lattice(0.05, 0.05)
N = len(ARRAY)
GAINS = np.ones(N)
POINTS = np.array([[0.01, 0.0, 0.1], [-0.01, 0.0, 0.1]])


@pytest.mark.parametrize(
    ("wrong", "argument"),
    [
        ({"array": "array"}, "array"),
        ({"gains": GAINS[:-1]}, "gains"),
        ({"gains": np.nan * GAINS}, "gains"),
        ({"gains": "gains"}, "gains"),
        ({"gains": np.empty((0, N))}, "gains"),
        ({"gains": np.stack([GAINS, GAINS]), "show": "phase"}, "show"),  # the moment is missing
        ({"plane": "zz"}, "plane"),
        ({"plane": ["xy"]}, "plane"),
        ({"plane": pc.Pose(), "at": (0.0, 0.0, 0.1)}, "at"),
        ({"at": (0.0, 0.0)}, "at"),
        ({"at": (0.0, 0.0, np.nan)}, "at"),
        ({"at": (0.0, 0.0, 150.0)}, "at"),  # millimetres
        ({"show": "colour"}, "show"),
        ({"size": -1.0}, "size"),
        ({"size": (0.1, 0.1, 0.1)}, "size"),
        ({"size": 200.0}, "size"),
        ({"points": [1.0, 2.0]}, "points"),
        ({"ax": "axes"}, "ax"),
        ({"medium": "air"}, "medium"),
    ],
)
def test_bad_arguments_of_a_slice_are_named(wrong: Any, argument: str) -> None:
    with pytest.raises(pc.ArgumentError) as told:
        plot.field(**{"array": ARRAY, "gains": GAINS, "medium": pc.Air()} | wrong)
    assert told.value.argument == argument


@pytest.mark.parametrize(
    ("make", "argument"),
    [
        (lambda: plot.slices(ARRAY, GAINS, [[0.0, 0.0]], medium=pc.Air()), "points"),
        (lambda: plot.slices(ARRAY, GAINS, 1e3 * POINTS, medium=pc.Air()), "points"),
        (lambda: plot.slices("array", GAINS, POINTS, medium=pc.Air()), "array"),  # type: ignore[arg-type]
        (lambda: plot.drive("array", GAINS), "array"),  # type: ignore[arg-type]
        (lambda: plot.drive(ARRAY, GAINS[:-1]), "gains"),
        (lambda: plot.drive(ARRAY, np.full(N, np.inf)), "gains"),
        (lambda: plot.drive(ARRAY, ["a"] * N), "gains"),  # type: ignore[list-item]
        (lambda: plot.drive(ARRAY, GAINS, "power"), "show"),  # type: ignore[arg-type]
        (lambda: plot.timeline(None), "run"),  # type: ignore[arg-type]
        (lambda: plot.convergence(ARRAY, POINTS, [1.0, 1.0], [], medium=pc.Air()), "solvers"),
        (lambda: plot.convergence(ARRAY, POINTS, [1.0], ["gs"], medium=pc.Air()), "amplitudes"),
    ],
)
def test_bad_arguments_are_named(make: Callable[[], Any], argument: str) -> None:
    with pytest.raises(pc.ArgumentError) as told:
        make()
    assert told.value.argument == argument


@pytest.mark.parametrize(
    ("draw", "panels"),
    [
        (lambda ax: plot.field(ARRAY, GAINS, ax=ax, medium=pc.Air()), 1),
        (lambda ax: plot.drive(ARRAY, GAINS, ax=ax), 2),
        (lambda ax: plot.drive(ARRAY, GAINS, "amplitude", ax=ax), 1),
        (lambda ax: plot.timeline(pc.Report(), ax=ax), 3),
        (lambda ax: plot.timeline(pc.Report(), "error", ax=ax), 1),
        (lambda ax: plot.convergence(ARRAY, POINTS, [1.0, 1.0], ["gs"], ax=ax, medium=pc.Air()), 1),
    ],
)
def test_it_draws_into_given_axes(draw: Any, panels: int, axes: Callable[..., Any]) -> None:
    mine = axes(panels)
    made = draw(mine)
    assert made is mine if panels == 1 else list(made) == list(mine)
    for panel in mine if panels > 1 else [mine]:
        assert panel.get_xlabel() or panel.get_ylabel()
        assert panel.has_data() or panels == 3  # the report is empty
        assert panel.xaxis.label.get_size() == axes().xaxis.label.get_size()  # the caller's style
    if panels > 1:
        with pytest.raises(pc.ArgumentError, match=f"{panels} of them"):
            draw(axes())
