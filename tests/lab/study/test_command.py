"""`pacinian study`: what it tells, writes and refuses."""

from __future__ import annotations

import json
from itertools import islice
from typing import TYPE_CHECKING, Any

import pytest
from click.testing import CliRunner

import pacinian as pc
import pacinian_lab.study as ps
from pacinian_lab.commands.study import study
from pacinian_lab.study import charts
from pacinian_lab.study.store import Folder

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

TINY = """
picture = { side = 0.1, step = 0.01 }
[[layouts]]
type = "lattice"
width = 0.02
[[patterns]]
type = "focus"
[[planes]]
z = [0.1, 0.12]
"""


def run(*arguments: object) -> Any:
    return CliRunner().invoke(study, [str(argument) for argument in arguments])


def test_a_list_shows_the_tasks_and_does_nothing(
    write: Callable[..., Path], tmp_path: Path
) -> None:
    path, out = write(TINY), tmp_path / "out"
    result = run(path, "--out", out, "--list")
    assert result.exit_code == 0
    assert "  lattice | plane z=0.1 | focus | auto | level 0.5" in result.stdout
    assert "2 tasks, 2 to do" in result.stdout
    assert not out.exists()
    ps.run(path, out, workers=0)
    assert "+ lattice | plane z=0.1 | focus" in run(path, "--out", out, "--list").stdout
    told = json.loads(run(path, "--out", out, "--list", "--json").stdout)
    assert (len(told["tasks"]), told["missing"]) == (2, 0)
    assert told["tasks"][0]["layout.width"] == 0.02


def test_a_list_is_json_at_the_highest_level(write: Callable[..., Path], tmp_path: Path) -> None:
    def refuse(constant: str) -> None:
        raise AssertionError(f"{constant} is not JSON")

    path = write(f"levels = [0.5, inf]\n{TINY}")
    listed = run(path, "--out", tmp_path / "out", "--list", "--json").stdout
    tasks = json.loads(listed, parse_constant=refuse)["tasks"]
    assert {task["level"] for task in tasks} == {0.5, "inf"}


def test_it_runs_reports_and_goes_on_after_a_change(
    write: Callable[..., Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(charts, "MESSAGES", dict(islice(charts.MESSAGES.items(), charts.ACROSS)))
    monkeypatch.setattr(charts, "AGAINST", charts.AGAINST[:1])
    path, out = write(TINY), tmp_path / "out"
    result = run(path, "--out", out, "--workers", 0)
    assert result.exit_code == 0, result.output
    assert "2 tasks, 2 of them run now, 0 failed" in result.stdout
    for name in ("results.parquet", "report.md", "layouts.png", "images-1.png", "trends.png"):
        assert f"wrote {out / name}" in result.stdout
        assert (out / name).exists()
    path.write_text(TINY.replace("0.12", "0.14"))
    result = run(path, "--out", out, "--workers", 0, "--no-pictures", "--json")
    assert "the study has changed: 1 tasks are new, 1 no longer needed" in result.stderr
    assert "1 of 2 tasks were done before" in result.stderr
    told = json.loads(result.stdout)
    assert (told["tasks"], told["done_now"], told["failures"]) == (2, 1, 0)
    assert told["files"] == [str(out / "results.parquet")]


def test_a_failure_is_told_by_the_exit_code(write: Callable[..., Path], tmp_path: Path) -> None:
    path = write(TINY.replace("0.12", "0.0"))
    result = run(path, "--out", tmp_path / "out", "--workers", 0, "--no-pictures")
    assert result.exit_code == 1
    assert "2 tasks, 2 of them run now, 1 failed" in result.stdout
    assert "1 failed: " in result.stderr


def test_a_part_that_cannot_be_read_is_told(write: Callable[..., Path], tmp_path: Path) -> None:
    path, out = write(TINY), tmp_path / "out"
    ps.run(path, out, workers=0)
    part = next((out / "parts").iterdir())
    part.write_text("no table")
    result = run(path, "--out", out, "--workers", 0, "--no-pictures")
    assert f"cannot read results, so their tasks run again: {part}" in result.stderr
    assert "2 tasks, 1 of them run now" in result.stdout
    assert part.with_suffix(".unreadable").read_text() == "no table"
    result = run(path, "--out", out, "--workers", 0, "--no-pictures")
    assert "cannot read results" not in result.stderr
    assert "2 tasks, 0 of them run now" in result.stdout


def test_a_second_run_in_the_same_folder_is_refused(
    write: Callable[..., Path], tmp_path: Path
) -> None:
    path, out = write(TINY), tmp_path / "out"
    with Folder(out).lock():
        error = run(path, "--out", out, "--workers", 0, "--no-pictures").exception
    assert isinstance(error, pc.RecordingError)
    assert f"{out}: is in use by another run" in str(error)
    assert run(path, "--out", out, "--workers", 0, "--no-pictures").exit_code == 0


def test_a_folder_that_cannot_be_made_is_named(write: Callable[..., Path], tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    error = run(write(TINY), "--out", tmp_path / "file" / "out", "--workers", 0).exception
    assert isinstance(error, pc.RecordingError)
    assert f"{tmp_path / 'file' / 'out'}: cannot be made" in str(error)


def test_a_report_that_was_not_written_again_is_called_old(
    write: Callable[..., Path], tmp_path: Path
) -> None:
    path, out = write(TINY), tmp_path / "out"
    out.mkdir()
    (out / "report.md").touch()
    result = run(path, "--out", out, "--workers", 0, "--no-pictures")
    assert "report.md and its pictures are of an earlier run" in result.stderr


def test_an_interruption_says_how_to_go_on(
    write: Callable[..., Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupted(batch: object) -> Any:
        raise KeyboardInterrupt

    monkeypatch.setattr("pacinian_lab.study.study_run.measure", interrupted)
    result = run(write(TINY), "--out", tmp_path / "out", "--workers", 0)
    assert result.exit_code != 0
    assert "finished tasks are kept: run the same command to continue" in result.stderr


def test_the_schema_needs_no_file() -> None:
    assert json.loads(run("--schema").stdout)["title"] == "Pacinian study"


def test_without_matplotlib_there_is_a_table_and_a_word(
    write: Callable[..., Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from pacinian_lab.study import report

    def missing(*_: object) -> Any:
        raise pc.MissingExtra("matplotlib", "plot")

    monkeypatch.setattr(report, "write", missing)
    result = run(write(TINY), "--out", tmp_path / "out", "--workers", 0)
    assert result.exit_code == 0
    assert "no pictures: matplotlib is not installed" in result.stderr


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        ([], "Missing argument 'FILE'"),
        (["x.toml", "--scheduler", "tcp://a:1", "--workers", "2"], "leave --scheduler out"),
        (["x.toml", "--workers", "-1"], "--workers"),
    ],
)
def test_a_call_that_cannot_be_meant_is_refused(arguments: list[str], says: str) -> None:
    result = run(*arguments)
    assert result.exit_code == 2
    assert says in result.stderr


def test_errors_of_the_file_come_before_anything_is_made(
    write: Callable[..., Path], tmp_path: Path
) -> None:
    out = tmp_path / "out"
    result = run(write('solvers = ["magic"]\n' + TINY), "--out", out)
    assert isinstance(result.exception, pc.SceneFileError)
    assert not out.exists()
