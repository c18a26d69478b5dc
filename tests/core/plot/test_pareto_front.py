"""Run time against error: the benchmark's file and its cells give the same picture."""

import json
import math
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from matplotlib.text import Text

import pacinian as pc
from pacinian import plot
from pacinian.plot.labels import label
from pacinian.plot.pareto_front import MIN_DRAWN_ERROR
from pacinian_lab.solvers.report import plain
from pacinian_lab.solvers.rows import Row
from pacinian_lab.solvers.summary import cells

TIMES = {"auto": (1e-4, 1e-5), "slow": (1e-2, 1e-9), "poor": (5e-5, 0.2), "beaten": (2e-4, 0.1)}


def rows() -> list[Row]:
    return [
        Row("pacinian", name, "cold", 1, 1, N, M, level, 0, "ok", p50, p50, 9, error, error, 1.0)
        for name, (p50, error) in TIMES.items()
        for N, M, level in ((249, 4, 0.5), (249, 16, 0.5), (996, 4, 0.5), (249, 4, 1.0))
    ]


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "bench.json"
    path.write_text(json.dumps(plain(rows(), [])))
    return path


def places(panel: Any) -> dict[str, tuple[float, float]]:
    """Return the position of each filled mark [ms], [%], by the label that points at it."""
    return {text.get_text(): text.xy for text in panel.texts if hasattr(text, "xy")}


def test_each_solver_is_where_it_was_measured(file: Path) -> None:
    (panel,) = plot.pareto(file, N=249, M=4).axes
    found = places(panel)
    assert set(found) == set(TIMES)
    for name, (p50, error) in TIMES.items():
        assert found[name] == pytest.approx((1e3 * p50, max(100.0 * error, MIN_DRAWN_ERROR)))


def test_the_front_is_what_nothing_beats_in_both(file: Path) -> None:
    (panel,) = plot.pareto(file, N=249, M=4).axes
    (front,) = (line for line in panel.lines if line.get_drawstyle() == "steps-post")
    x, y = np.asarray(front.get_data())
    np.testing.assert_allclose(x[1:-1], [0.05, 0.1, 10.0])
    np.testing.assert_allclose(y[1:-1], [20.0, 1e-3, MIN_DRAWN_ERROR])


def test_a_file_and_its_cells_are_one_picture(file: Path) -> None:
    one, two = (plot.pareto(given, N=249, M=16) for given in (file, cells(rows())))
    assert places(one.axes[0]) == places(two.axes[0])


def test_there_is_a_panel_for_each_size_and_the_lowest_level_is_shown(file: Path) -> None:
    assert len(plot.pareto(file).axes) == 4
    assert len(plot.pareto(file, N=249).axes) == 2
    assert len(plot.pareto(file, level=1.0).axes) == 1


def test_it_draws_into_given_axes(file: Path, axes: Callable[..., Any]) -> None:
    mine = axes()
    assert plot.pareto(file, N=249, M=4, ax=mine) is mine
    with pytest.raises(pc.ArgumentError, match="give N and M"):
        plot.pareto(file, ax=mine)


@pytest.mark.parametrize("wrong", [{"level": 0.7}, {"N": 1}, {"M": 5}])
def test_what_was_not_measured_is_told(file: Path, wrong: Any) -> None:
    with pytest.raises(pc.ArgumentError, match="measurement at level"):
        plot.pareto(file, **wrong)
    with pytest.raises(pc.ArgumentError, match="measurement at level"):
        plot.pareto([])


@pytest.mark.parametrize(
    "text", ["", "{", "[]", "{}", '{"cells": [{"p50": 1}]}', '{"cells": [{"p50": "a"}]}', "\x00"]
)
def test_a_file_that_is_none_of_the_benchmarks_is_told(tmp_path: Path, text: str) -> None:
    path = tmp_path / "other.json"
    path.write_text(text)
    for given in (path, str(path), tmp_path / "absent.json"):
        with pytest.raises(pc.RecordingError, match=r"bench\.json"):
            plot.pareto(given)


def test_labels_keep_out_of_each_others_way() -> None:
    page = plot.figure(6.0, 4.0)
    panel = page.subplots()
    panel.set(xlim=(0, 1), ylim=(0, 1))
    page.draw_without_rendering()
    label(panel, [(f"solver {n}", 0.5, 0.5 + 1e-3 * n, "black") for n in range(8)], [(0.6, 0.5)])
    page.draw_without_rendering()
    boxes = [Text.get_window_extent(text) for text in panel.texts]  # without their leaders
    assert len(boxes) == 8
    assert not any(a.overlaps(b) for n, a in enumerate(boxes) for b in boxes[:n])


def test_what_was_not_measured_is_left_out_and_the_error_is_that_of_the_proportions() -> None:
    cells = plain(rows(), [])["cells"]
    broken = [
        {**cells[0], "solver": "odd", **wrong}
        for wrong in ({"p50": math.nan}, {"error": math.nan}, {"p50": 0.0}, {"error": math.inf})
    ]
    (panel,) = plot.pareto([SimpleNamespace(**c) for c in (*cells, *broken)], N=249, M=4).axes
    assert "odd" not in " ".join(places(panel))
    assert panel.get_ylabel() == "error of the proportions [%]"
