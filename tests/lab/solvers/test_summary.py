"""Medians, targets, exponents, tables and pictures, of rows made up."""

import json
import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from rich.console import Console

from pacinian_lab.solvers import plots, report, tables
from pacinian_lab.solvers.rows import Row
from pacinian_lab.solvers.summary import cells, fastest, growth
from pacinian_lab.solvers.targets import TARGETS, verdicts
from pacinian_lab.solvers.worker_process import Worker

SIZES = [(249, 4), (249, 64), (2241, 4), (2241, 64)]


def row(family: str, solver: str, N: int, M: int, p50: float, **more: Any) -> Row:
    given = {"mode": "cold", "threads": 1, "level": 0.5, "seed": 0, "units": 1} | more
    numbers = {"error": 1e-3, "error_8bit": 2e-3, "scale": 1.0, "mean_pressure": 100.0, "drive": 1.0,
               "p99": 2 * p50, "samples": 500, "traced": 1e6, "resident": 1e8}  # fmt: skip
    return Row(family, solver, N=N, M=M, p50=p50, **(numbers | given))


def everything() -> list[Row]:
    """A run with a power law, t = 1e-6 N^0.5 M^1.5, for ours, and multiples of it for the rest."""
    rows: list[Row] = []
    for N, M in SIZES:
        t = 1e-6 * N**0.5 * M**1.5
        for level in (0.5, 1.0):
            for seed in (0, 1, 2):
                place = {"level": level, "seed": seed}
                rows += [
                    row("pacinian", "auto", N, M, t, error=1e-5, **place),
                    row("pacinian", "auto", N, M, 5 * t, threads=2, error=1e-5, **place),
                    row("pacinian", "auto", N, M, t / 2, mode="warm", error=1e-5, **place),
                    row("pacinian", "auto", N, M, t / 20, mode="rescaled", **place),
                    row("reference", "roofline", N, M, t / 2, mode="reference", **place),
                    row("reference", "gemm", N, M, 1e-3, mode="reference", **place),
                    row("autd3", "autd3-gspat", N, M, 1.5 * t, **place),
                    row("levitate", "levitate", N, M, 40 * t, **place),
                ]
    return rows


def test_the_fastest_number_of_threads_counts() -> None:
    rows = [row("autd3", "a", 249, 4, t, threads=n) for n, t in ((1, 3.0), (2, 2.0), (4, 2.5))]
    rows.append(replace(rows[1], p50=1e-9, status="timed out after 1 s"))
    (best,) = fastest(rows, "a", "cold").values()
    assert (best.threads, best.p50) == (2, 2.0)
    (cell,) = cells(rows)
    assert (cell.threads, cell.p50) == (2, 2.0)


def test_a_cell_is_the_median_of_the_seeds() -> None:
    rows = [row("a", "a", 249, 4, float(t), seed=n) for n, t in enumerate((5, 1, 2))]
    (cell,) = cells(rows)
    assert (cell.p50, cell.note) == (2.0, "")


def test_what_was_never_measured_says_why() -> None:
    (cell,) = cells([replace(row("a", "a", 249, 4, 1.0), status="timed out after 1 s")])
    assert cell.note == "timed out after 1 s"
    assert math.isnan(cell.p50)


def test_targets_are_ratios_to_the_rivals() -> None:
    found = {v.target.name: v for v in verdicts(everything())}
    assert len(found) == len(TARGETS)
    worst = {name: pytest.approx(v.worst) for name, v in found.items()}
    met = {name: (v.met, v.of) for name, v in found.items()}
    assert met["level 0.5: error"] == (4, 4)
    assert worst["level 0.5: error"] == 1e-5
    assert worst["level 0.5: time over autd3-gspat's"] == 1 / 1.5
    assert met["level 1.0: time over levitate's"] == (0, 4)
    assert worst["level 1.0: time over levitate's"] == 1 / 40
    assert worst["level 1.0: error over levitate's by"] == 1e-5 - 1e-3
    assert met["N M >= 35000: time over the roofline"] == (
        2,
        2,
    )  # of four sizes, at two levels, one
    assert worst["N M >= 35000: time over the roofline"] == 2.0
    assert worst["level 0.5: time over cold where only the strength changed"] == 1 / 20
    assert met["p99/p50 over that of a fixed GEMM"] == (8, 8)


def test_a_rival_that_failed_is_not_compared_with_and_silence_misses() -> None:
    rows = [r for r in everything() if r.solver != "levitate"]
    names = {v.target.name for v in verdicts(rows)}
    assert not any("levitate" in name for name in names)
    silent = [replace(r, error=math.nan, scale=0.0) for r in rows]
    found = {v.target.name: v for v in verdicts(silent)}
    assert found["level 0.5: error"].met == 0


def test_exponents_of_a_power_law_are_found() -> None:
    lines = {(g.solver, g.along): g for g in growth(cells(everything()))}
    assert lines["auto", "N"].exponent == pytest.approx(0.5)
    assert lines["auto", "M"].exponent == pytest.approx(1.5)
    assert lines["auto", "N"].fixed == 64
    assert lines["auto", "M"].fixed == 2241
    assert ("gemm", "N") not in lines
    assert growth([]) == []


def test_tables_fit_eighty_columns_and_tell_all() -> None:
    rows = everything()
    rows += [replace(r, solver="acoustools-gspat") for r in rows if r.solver == "levitate"]
    rows += [replace(r, M=16) for r in rows if r.M == 64]
    rows.append(replace(rows[0], solver="late", status="timed out after 1 s"))
    console = Console(width=200, record=True, file=open("/dev/null", "w"))  # noqa: SIM115
    for table in [*tables.results(cells(rows)), tables.updates(cells(rows)), tables.resources(rows),
                  tables.exponents(growth(cells(rows))), tables.verdicts(verdicts(rows))]:  # fmt: skip
        console.print(table)
    text = console.export_text()
    console.file.close()
    assert max(len(line.rstrip()) for line in text.splitlines()) <= 80
    for part in ("Level 0.5, N = 249", "acoustools-gspat", "warm", "late", "M=16", "[ms]", "1.50"):
        assert part in text


def test_tables_of_nothing_are_empty() -> None:
    for table in (tables.updates([]), tables.resources([]), tables.verdicts([])):
        assert table.row_count == 0
    assert tables.results([]) == []


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0.0, "0"),
        (1e-7, "1e-7"),
        (0.0123, ".012"),
        (0.5, ".50"),
        (-0.5, "-.50"),
        (10.04, "10"),
        (1.04, "1.0"),
        (123.4, "123"),
        (math.nan, "-"),
    ],
)
def test_numbers_are_short(value: float, text: str) -> None:
    assert tables.short(value) == text


def test_the_report_is_json_without_nan() -> None:
    rows = [*everything(), replace(row("a", "a", 249, 4, 1.0), p50=math.nan, status="failed: x")]
    text = json.dumps(report.plain(rows, [Worker("a", [], 1)], limit=1.0), allow_nan=False)
    told = json.loads(text)
    assert {"rows", "cells", "targets", "growth", "machine", "versions", "limit"} <= told.keys()
    assert len(told["rows"]) == len(rows)


@pytest.fixture
def saved(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Names of the pictures that were made; `pacinian bench` writes real ones in its own tests."""
    names: list[str] = []
    monkeypatch.setattr(plots, "save", lambda page, path: names.append(path.name))
    return names


@pytest.mark.deep
def test_pictures_are_made_of_each_level_and_of_growth(tmp_path: Path, saved: list[str]) -> None:
    rows = [row for row in everything() if row.N == 249]
    rows.append(replace(rows[0], solver="late", status="timed out after 1 s"))
    files = plots.draw(cells(rows), tmp_path)
    assert saved == [
        "pareto-0.5.png",
        "pareto-0.5-all.png",
        "pareto-1.png",
        "pareto-1-all.png",
        "growth.png",
    ]
    assert files == [tmp_path / name for name in saved]


def test_a_run_of_one_problem_has_no_growth(tmp_path: Path, saved: list[str]) -> None:
    plots.draw(cells([row("pacinian", "auto", 249, 4, 1.0)]), tmp_path)
    assert saved == ["pareto-0.5.png", "pareto-0.5-all.png"]


def test_nothing_measured_is_no_picture(tmp_path: Path, saved: list[str]) -> None:
    failed = replace(row("pacinian", "auto", 249, 4, 1.0), status="failed: x")
    assert plots.draw(cells([failed]), tmp_path) == plots.draw([], tmp_path) == saved == []
