"""`pacinian stress`: what it prints and its exit codes."""

import json
from typing import Any, ClassVar

import pytest
from click.testing import CliRunner

import pacinian as pc
from pacinian.plugins import registry
from pacinian_lab.commands.stress import stress
from pacinian_lab.stress import cases, extreme_problems, guarantees, ill_conditioned_problems, run


@pytest.fixture(autouse=True)
def few(monkeypatch: pytest.MonkeyPatch) -> None:
    """Two families and few moves."""
    families = {"limits": extreme_problems.limits, "media": ill_conditioned_problems.media}
    monkeypatch.setattr(cases, "FAMILIES", families)
    monkeypatch.setattr(run, "COMPARISONS", 2)
    monkeypatch.setattr("pacinian_lab.commands.stress.MOVES", (100, 200))
    monkeypatch.setenv("COLUMNS", "80")


def ran(*arguments: str) -> Any:
    return CliRunner().invoke(stress, ["--quick", *arguments])


def test_it_prints_one_table_within_eighty_columns() -> None:
    result = ran("--solvers", "single-focus, gs-pat")
    assert result.exit_code == 0, result.output
    assert max(map(len, result.stdout.splitlines())) <= 80
    for word in ("limits", "media", "single-focus", "gs-pat", "propagator", "kept", "excess"):
        assert word in result.stdout
    assert "broken" not in result.stdout


@pytest.mark.parametrize("solvers", [",", "gs-pat,,gs", "gs-pat, gs-pat"])
def test_a_list_of_solvers_without_a_name_or_with_one_twice_is_refused(solvers: str) -> None:
    result = ran("--solvers", solvers)
    assert result.exit_code == 2
    assert "must be different names" in result.output


def test_json_is_one_object_on_standard_output() -> None:
    result = ran("--solvers", "single-focus", "--json")
    assert result.exit_code == 0
    found = json.loads(result.stdout)
    assert found["quick"]
    assert not found["broken"]
    assert set(found["guarantees"]) >= set(guarantees.EVERY)
    rows = {(row["family"], row["solver"]): row for row in found["rows"]}
    assert rows.keys() == {
        ("limits", "single-focus"), ("media", "single-focus"), ("moves", "propagator"),
    }  # fmt: skip
    assert rows["limits", "single-focus"]["excess"] <= 0.0
    assert rows["limits", "single-focus"]["ratio"] is None


class Breaks(pc.Solver):
    """A solver that fails."""

    name: ClassVar[str] = "breaks"

    def solve(self, *arguments: Any) -> pc.Result:
        raise RuntimeError("[bold]no[/bold]")


def test_a_broken_guarantee_is_told_with_what_repeats_it_and_exit_code_1(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(registry, "solver", lambda name: Breaks())
    result = ran("--solvers", "breaks")
    assert result.exit_code == 1
    assert "broken" in result.stdout
    assert "RuntimeError: [bold]no[/bold]" in result.stdout
    again = next(line for line in result.stdout.splitlines() if "cases.find" in line)
    assert cases.find(again.split('"')[1]).name
    found = json.loads(ran("--solvers", "breaks", "--json").stdout)
    assert found["broken"][0]["broken"] == {"raises": "RuntimeError: [bold]no[/bold]"}


def test_an_unknown_solver_is_an_error_with_those_there_are() -> None:
    result = ran("--solvers", "magic")
    assert isinstance(result.exception, pc.UnknownPlugin)
