"""`pacinian paper`: what it prints and writes."""

import builtins
import json
import sys

import pytest
from click.testing import CliRunner

import pacinian as pc
from pacinian.cli.paper import paper
from pacinian.paper import report


@pytest.fixture(scope="module")
def computed():
    return report.make()


@pytest.fixture
def runner(monkeypatch, computed):
    """A command line that finds the work done."""
    monkeypatch.setattr(report, "make", lambda advance: (advance(), computed)[1])
    monkeypatch.setenv("COLUMNS", "80")
    return CliRunner()


def test_every_step_is_counted_for_the_progress_bar(monkeypatch, computed):
    steps = []
    monkeypatch.setattr(report.experiment, "spectrum", lambda case: None)
    monkeypatch.setattr(report.experiment, "solve", lambda *_: None)
    monkeypatch.setattr(report.fourier, "compare", lambda *_: None)
    report.make(lambda: steps.append(1))
    assert len(steps) == report.STEPS


def test_json_is_one_object_on_standard_output_and_nothing_else(runner):
    result = runner.invoke(paper, ["--json", "--no-figures"])
    assert result.exit_code == 0
    found = json.loads(result.stdout)
    assert set(found) == {"experiment", "fourier", "focus", "figures"}
    assert found["figures"] == []
    assert len(found["experiment"]["outcomes"]) == 16
    conditions = {row["case"]: row["condition"] for row in found["experiment"]["cases"]}
    assert conditions["1a"] == pytest.approx(75.4, abs=0.1)
    assert conditions["2a"] is None
    assert [row["units"] for row in found["focus"]["forces"]] == [1, 9]


def test_tables_fit_eighty_columns_and_keep_their_units(runner):
    result = runner.invoke(paper, ["--no-figures"])
    assert result.exit_code == 0
    text = result.stdout
    assert max(map(len, text.splitlines())) <= 80
    for part in ("0.82 0.59 1.06", "0.31 0.95 0.33", "1681 x 861", "451", "[mm]", "[gf]", "17.0"):
        assert part in text
    assert "mirror-symmetric" in text


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
    for name in ("pacinian.paper.figures", "pacinian.paper.panels"):
        monkeypatch.delitem(sys.modules, name, raising=False)
    ordinary = builtins.__import__

    def absent(name, *args, **kwargs):
        if name.startswith("matplotlib"):
            raise ImportError(name)
        return ordinary(name, *args, **kwargs)

    monkeypatch.setattr(builtins, "__import__", absent)
    result = runner.invoke(paper, ["--out", str(tmp_path)])
    assert isinstance(result.exception, pc.MissingExtra)
    assert "pacinian[plot]" in str(result.exception)
    assert runner.invoke(paper, ["--no-figures"]).exit_code == 0
