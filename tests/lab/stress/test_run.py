"""The list of problems, the table, and the moves without end."""

import math
from pathlib import Path

import numpy as np
import pytest

import pacinian as pc
from pacinian_lab.stress import cases, guarantees, run
from pacinian_lab.stress.case import Case
from pacinian_lab.stress.check import Evidence

PAGE = (Path(__file__).parents[3] / "docs" / "stability.md").read_text()


@pytest.fixture(scope="module")
def every() -> list[Case]:
    return cases.cases()


def test_every_problem_has_a_name_of_its_own_and_is_found_by_it(every: list[Case]) -> None:
    assert len({case.name for case in every}) == len(every) > 700
    assert {case.name.partition(":")[0] for case in every} == set(cases.FAMILIES)
    assert cases.find(every[5].name).name == every[5].name


def test_a_quick_run_has_some_of_each_family_and_nothing_slow(every: list[Case]) -> None:
    quick = cases.cases(quick=True)
    assert {case.name.partition(":")[0] for case in quick} == set(cases.FAMILIES)
    assert not any(case.slow for case in quick)
    assert len(quick) < len(every) / 3


@pytest.mark.parametrize(
    "figure",
    [
        "0 m",
        "1e-09 m",
        "0.01 m",
        "0 points",
        "4096 points",
        "4.94066e-324 Pa",
        "1e-30 Pa",
        "1e+30 Pa",
        "1e16",
    ],
)
def test_the_problems_reach_as_far_as_is_said(every: list[Case], figure: str) -> None:
    assert any(f" {figure}" in case.name for case in every)


def test_the_page_has_every_family_and_every_guarantee() -> None:
    for name in (*cases.FAMILIES, *guarantees.EVERY, *guarantees.OURS, *guarantees.PROPAGATOR):
        assert f"| `{name}` |" in PAGE, name
    for name in guarantees.GUARANTEES:
        assert f"`{name}`" in PAGE, name


def test_rows_are_by_family_and_solver_with_the_worst() -> None:
    found = [
        Evidence("a: 1", "x", {}, -0.5, 0.9, 1.0),
        Evidence("b: 1", "x", {}, math.nan, math.nan, 2.0),
        Evidence("a: 1", "y", {}, -0.1, 0.1, 1.0),
        Evidence("a: 2", "x", {"gain": "1"}, 0.1, 0.2, 3.0),
    ]
    table = {(row.family, row.solver): row for row in run.rows(found)}
    assert list(table) == [("a", "x"), ("b", "x"), ("a", "y")]
    worst = table["a", "x"]
    assert (worst.problems, len(worst.broken), worst.where) == (2, 1, "2")
    assert (worst.excess, worst.ratio, worst.seconds) == (0.1, 0.9, 3.0)
    assert table["b", "x"].where == ""


def test_moves_do_not_drift() -> None:
    evidence = run.drift(3000)
    assert not evidence.broken
    assert evidence.ratio <= 1.0


def test_a_drift_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    class Lazy(pc.Propagator):
        def set_points(self, points: pc.Floats) -> int:
            return super().set_points(points) if self.version < 50 else 0

    monkeypatch.setattr(run, "Propagator", Lazy)
    assert "drift" in run.drift(200).broken


def test_all_installed_solvers_are_tried_and_a_bad_name_is_told() -> None:
    assert set(run.solvers()) >= set(guarantees.GUARANTEES)
    with pytest.raises(pc.UnknownPlugin):
        run.run(["magic"], [])
    seen: list[str] = []
    (evidence,) = run.run(["gs-pat"], [cases.find("extreme: zeros, free")], seen.append)
    assert evidence.solver == "gs-pat"
    assert seen == ["gs-pat, extreme: zeros, free"]
    assert np.isnan(evidence.ratio)
