"""`pacinian bench batches`: every contestant solves the same problems, and its result is checked."""

import json
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner

from pacinian.cli.main import cli
from pacinian_lab.solvers import batches
from pacinian_lab.solvers.batches import Batch, Library, measure

ARGUMENTS = "--units", "1", "--points", "2", "--problems", "3", "--field", "50", "--seconds", "0"


def test_a_tiny_run_has_a_row_for_each_contestant() -> None:
    result = CliRunner().invoke(cli, ["bench", "batches", *ARGUMENTS, "--json"])
    assert result.exit_code == 0, result.output
    rows = json.loads(result.stdout)
    assert {row["job"] for row in rows} == {"solve", "field"}
    solved = {row["contestant"]: row for row in rows if row["job"] == "solve"}
    expected = "solve_many, pseudo-inverse, 1 core", "solve_many, auto, 1 core", "array_api, NumPy"
    assert set(expected) <= solved.keys()
    assert all(row["count"] == 3 and row["seconds"] > 0.0 for row in solved.values())
    assert all(row["error"] < 0.02 for row in solved.values())
    assert all(row["error"] < 1e-4 for row in rows if row["job"] == "field")
    table = CliRunner().invoke(cli, ["bench", "batches", *ARGUMENTS])
    assert "3 problems of 2 points, 1 units" in table.output
    assert CliRunner().invoke(cli, ["bench", "batches", "--units", "2"]).exit_code == 2


def test_a_library_that_computes_nonsense_shows_it(monkeypatch: pytest.MonkeyPatch) -> None:
    def halve(made: Any) -> Any:
        return 0.5 * np.asarray(made)

    monkeypatch.setattr(batches, "find_libraries", lambda: [Library("halves", np.asarray, halve)])
    rows = {(row.job, row.contestant): row.error for row in measure(1, 2, 3, 50, 0.0)}
    assert rows["solve", "array_api, halves"] == pytest.approx(0.5, abs=0.02)
    assert rows["field", "array_api, halves"] == pytest.approx(0.5, rel=1e-4)


def test_the_error_is_that_of_the_pressures() -> None:
    batch = Batch.make(1, 2, 3)
    assert batch.error(np.zeros((3, 249), np.complex64)) == 1.0
