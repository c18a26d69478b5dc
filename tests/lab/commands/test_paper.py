"""`pacinian paper`: what it prints and writes of numbers that are made up; tests/lab/paper has the real ones."""

import builtins
import json
import math
import sys

import numpy as np
import pytest
from click.testing import CliRunner

import pacinian as pc
from pacinian_lab.commands.paper import paper
from pacinian_lab.paper import experiment, report


@pytest.fixture(scope="module")
def computed():
    """A report whose matrices were not decomposed, and how many of its steps were told."""
    steps = []

    def spectrum(case):
        condition = math.inf if case.name == "2a" else 75.4
        return experiment.Spectrum(
            case.name, len(case.points), len(case.array), 451, condition, 7.0
        )

    def solve(case, name, cut=0.0):
        target = experiment.pattern(name)
        return experiment.Outcome(case.name, name, target, np.sqrt(target), 0.12, 0.34, 5.67)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(experiment, "spectrum", spectrum)
        patch.setattr(experiment, "solve", solve)
        return report.make(lambda: steps.append(1)), len(steps)


@pytest.fixture
def runner(monkeypatch, computed):
    """A command line that finds the work done."""
    monkeypatch.setattr(report, "make", lambda advance: (advance(), computed[0])[1])
    monkeypatch.setenv("COLUMNS", "80")
    return CliRunner()


def test_every_step_is_counted_for_the_progress_bar(computed):
    assert computed[1] == report.STEPS


def test_json_is_one_object_on_standard_output_and_nothing_else(runner):
    result = runner.invoke(paper, ["--json", "--no-figures"])
    assert result.exit_code == 0
    found = json.loads(result.stdout)
    assert set(found) == {"experiment", "fourier", "focus", "figures"}
    assert found["figures"] == []
    assert len(found["experiment"]["outcomes"]) == 16
    conditions = {row["case"]: row["condition"] for row in found["experiment"]["cases"]}
    assert conditions == {"1a": 75.4, "1b": 75.4, "2a": None, "2b": 75.4}
    assert [row["units"] for row in found["focus"]["forces"]] == [1, 9]


def test_tables_fit_eighty_columns_and_keep_their_units(runner):
    result = runner.invoke(paper, ["--no-figures"])
    assert result.exit_code == 0
    text = result.stdout
    assert max(map(len, text.splitlines())) <= 80
    for part in ("0.12 0.34 5.67", "1681 x 861", "451", "infinite", "[mm]", "[gf]", "17.0"):
        assert part in text
    assert "mirror-symmetric" in text


@pytest.mark.deep
def test_figures_are_written_as_png_files_and_named(runner, tmp_path):
    result = runner.invoke(paper, ["--out", str(tmp_path / "new" / "folder"), "--json"])
    assert result.exit_code == 0
    files = sorted((tmp_path / "new" / "folder").iterdir())
    assert [file.name for file in files] == ["experiment.png", "focus.png", "fourier.png"]
    assert all(file.read_bytes().startswith(b"\x89PNG") for file in files)
    assert sorted(json.loads(result.stdout)["figures"]) == [str(file) for file in files]


def test_a_folder_that_cannot_be_made_is_told_before_the_work(runner, tmp_path, monkeypatch):
    (tmp_path / "file").write_text("")
    monkeypatch.setattr(report, "make", lambda advance: pytest.fail("worked in vain"))
    result = runner.invoke(paper, ["--out", str(tmp_path / "file" / "folder")])
    assert result.exit_code == 2
    assert "--out" in result.stderr


def test_a_missing_matplotlib_is_told_before_the_work_and_not_needed_without_figures(
    runner, monkeypatch, tmp_path
):
    for name in ("pacinian_lab.paper.figures", "pacinian_lab.paper.panels"):
        monkeypatch.delitem(sys.modules, name, raising=False)
    ordinary = builtins.__import__

    def absent(name, *args, **kwargs):
        if name.startswith("matplotlib"):
            raise ImportError(name)
        return ordinary(name, *args, **kwargs)

    monkeypatch.setattr(builtins, "__import__", absent)
    result = runner.invoke(paper, ["--out", str(tmp_path)])
    assert isinstance(result.exception, pc.MissingExtra)
    assert '[plot]"' in str(result.exception)
    assert runner.invoke(paper, ["--no-figures"]).exit_code == 0
