"""`pacinian bench`, as a user runs it, on problems so small that it takes seconds."""

import csv
import dataclasses
import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner

import pacinian as pc
from pacinian.cli.main import cli
from pacinian_lab.regions import skin
from pacinian_lab.scenes import audibility, growth, savings
from pacinian_lab.scenes import run as scenes
from pacinian_lab.scenes.audibility import CASES, Sound
from pacinian_lab.scenes.growth import Growth
from pacinian_lab.scenes.savings import Saving
from pacinian_lab.solvers import peers, plots

FAKE = Path(__file__).parents[1] / "solvers" / "fake.py"
LIMIT = 200.0  # [s] ends a test that hangs
TINY = ("--units", "1", "--points", "2,3", "--levels", "0.5", "--seeds", "1", "--seconds", "0")


def run(*arguments: str) -> Any:
    return CliRunner().invoke(cli, ["bench", *arguments])


def read(table: Path) -> list[dict[str, str]]:
    with table.open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def test_a_tiny_run_writes_and_tells_everything(tmp_path: Path) -> None:
    result = run(
        *TINY, "--quick", "--solvers", "pseudo-inverse,gs-pat", "--out", str(tmp_path), "--json"
    )
    assert result.exit_code == 0, result.output
    told = json.loads(result.stdout)
    assert json.loads((tmp_path / "bench.json").read_text())["rows"] == told["rows"]
    assert not told["interrupted"]
    assert told["versions"]["pacinian"]["numpy"]
    rows = read(tmp_path / "bench.csv")
    assert len(rows) == len(told["rows"]) == 2 * (2 + 2 * 4)
    assert all(row["status"] == "ok" and float(row["p50"]) > 0.0 for row in rows)
    good = [row for row in rows if row["solver"] == "pseudo-inverse"]
    assert all(float(row["error"]) < 1e-4 and int(row["samples"]) >= 1 for row in good)
    assert {row["mode"] for row in good} == {"cold", "warm", "one moved", "rescaled"}
    names = {"bench.csv", "bench.json", "pareto-0.5.png", "pareto-0.5-all.png", "growth.png"}
    assert {Path(file).name for file in told["files"]} == names
    assert names == {file.name for file in tmp_path.iterdir()}


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("--points", "4;5"), "no list of numbers"),
        (("--units", "a"), "no list of numbers"),
        (("--seeds", "0"), "--seeds"),
        (("--threads", "0"), "--threads"),
    ],
)
def test_a_bad_argument_is_told(tmp_path: Path, arguments: Any, says: str) -> None:
    result = run(*arguments, "--out", str(tmp_path))
    assert result.exit_code == 2
    assert says in result.stderr


def test_what_is_not_there_is_told_before_the_work(tmp_path: Path) -> None:
    assert isinstance(run("--solvers", "magic", "--out", str(tmp_path)).exception, pc.UnknownPlugin)
    assert isinstance(run("--units", "2", "--out", str(tmp_path)).exception, pc.ArgumentError)
    (tmp_path / "file").write_text("")
    result = run("--out", str(tmp_path / "file" / "folder"))
    assert result.exit_code == 2
    assert "--out" in result.stderr


def test_missing_peers_are_told_with_the_command_to_run(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    result = run("--quick", "--out", str(tmp_path), "--peers", str(tmp_path / "none"))
    assert result.exit_code == 2
    assert f".ci/peers {tmp_path / 'none'}" in result.stderr
    monkeypatch.setenv(peers.VARIABLE, str(tmp_path / "elsewhere"))
    result = run("--peers", "--quick", "--out", str(tmp_path))  # the value may be left out
    assert f".ci/peers {tmp_path / 'elsewhere'}" in result.stderr
    monkeypatch.delenv(peers.VARIABLE)
    assert peers.find_folder().parts[-2:] == ("pacinian", "peers")


@pytest.mark.skipif(sys.platform == "win32", reason="a shell script stands for Python")
def test_without_json_tables_tell_of_peers_beside_ours_and_of_their_faults(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(plots, "draw", lambda cells, folder: [])  # drawn above
    for peer, how in (("autd3", "works"), ("levitate", "crashes"), ("acoustools", "dies at once")):
        python = tmp_path / peer / "bin" / "python"
        python.parent.mkdir(parents=True)
        python.write_text(f"#!/bin/sh\nexec {sys.executable} {FAKE} '{how}'\n")
        python.chmod(0o755)
    out = tmp_path / "new" / "folder"
    result = run(*TINY, "--quick", "--solvers", "auto", "--out", str(out), "--peers", str(tmp_path))
    assert result.exit_code == 0, result.output
    for word in ("Level 0.5", "N = 249", "roofline", "auto", "warm", "Targets", "wrote"):
        assert word in result.stdout
    rows = read(out / "bench.csv")
    status = {row["family"]: row["status"] for row in rows}
    assert status == {
        "reference": "ok", "pacinian": "ok", "autd3": "ok", "levitate": "crashed: last words",
    }  # fmt: skip
    assert "crashed: last words" in result.stdout
    assert "acoustools left out: it crashed: no such library" in result.stderr
    one = [row for row in rows if row["family"] == "autd3"]
    assert all(float(row["error"]) > 0.0 for row in one)


@pytest.mark.skipif(sys.platform == "win32", reason="signals")
def test_ctrl_c_keeps_what_was_measured(tmp_path: Path) -> None:
    with subprocess.Popen(
        [sys.executable, "-m", "pacinian", "bench", "--quick", "--units", "1", "--seeds", "500",
         "--points", "2,3", "--levels", "0.5", "--solvers", "pseudo-inverse", "--out", str(tmp_path), "--json"],
        stdout=subprocess.PIPE, text=True, start_new_session=True,
    ) as child:  # fmt: skip
        try:
            table, end = tmp_path / "bench.csv", time.monotonic() + LIMIT
            while not (table.exists() and table.read_text().count("\n") > 3):
                assert time.monotonic() < end
                time.sleep(0.02)  # for another process, which has no clock of ours
            os.killpg(child.pid, signal.SIGINT)  # as a terminal does
            out, _ = child.communicate(timeout=LIMIT)
        except BaseException:
            os.killpg(child.pid, signal.SIGKILL)
            raise
    assert child.returncode == 130
    told = json.loads(out)
    assert told["interrupted"]
    assert len(told["rows"]) >= 3
    assert len(read(table)) - len(told["rows"]) in (0, 1)  # one may have been under way


ROW = scenes.Row(
    "palm", 0.6, 1.2, 0.01, 0.0, 500.0, 400.0, 2.5, 60, {"solve": 0.3}, 0.001, None, 0.1
)


@pytest.fixture
def quick(monkeypatch: pytest.MonkeyPatch) -> None:
    """Nothing is measured: numbers are made up."""

    def row(array: pc.Array, name: str, seconds: float) -> scenes.Row:
        if name == "rain" and seconds == 66.0:
            raise KeyboardInterrupt
        return dataclasses.replace(ROW, scene=name)

    monkeypatch.setattr(scenes, "measure", row)
    monkeypatch.setattr(
        savings, "measure", lambda array, skip, ticks: Saving(skip.what, 0.1, 1.0, skip.limit)
    )
    monkeypatch.setattr(
        growth, "measure", lambda array, ticks: [Growth(n, 1.0, 1.0, 1.0) for n in (1, 10_000)]
    )
    silent = (-80.0, -80.0, -80.0)
    monkeypatch.setattr(
        audibility, "measure", lambda array: [Sound(what, silent, silent) for what in CASES]
    )


def test_a_scene_is_measured_and_told_as_a_list_of_rows(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(skin, "_fine", lambda: None)  # of hands, which these scenes do not have
    result = run(
        "scenes", "--scene", "static-focus", "--scene", "empty", "--units", "1",
        "--seconds", "0.05", "--json",
    )  # fmt: skip
    assert result.exit_code == 0, result.output
    rows = json.loads(result.stdout)
    assert [row["scene"] for row in rows] == ["static-focus", "empty"]
    assert {"p50_ms", "p99_ms", "late", "dummy_late", "rate", "samples", "stages", "felt"} <= rows[
        0
    ].keys()
    assert rows[0]["error_at_samples"] < 0.05


@pytest.mark.usefixtures("quick")
def test_scenes_without_json_are_tables_with_skips_growth_and_targets(tmp_path: Path) -> None:
    out = tmp_path / "deep" / "scenes.json"
    result = run("scenes", "--out", str(out))
    assert result.exit_code == 0, result.output
    for word in (
        "stm-circle",
        "dummy",
        "nothing changed",
        "10000",
        *CASES,
        "missed",
        "500 Hz held",
        "met",
    ):
        assert word in result.stdout
    told = json.loads(out.read_text())
    assert len(told["rows"]) == 9
    assert told["savings"]
    assert told["growth"]
    assert not told["interrupted"]
    few = run("scenes", "--scene", "palm")
    assert "nothing changed" not in few.stdout


@pytest.mark.usefixtures("quick")
def test_ctrl_c_keeps_the_scenes_that_were_measured() -> None:
    result = run("scenes", "--seconds", "66", "--json")
    assert result.exit_code == 130
    assert [row["scene"] for row in json.loads(result.stdout)][-1] == "stm-circle"


def test_pictures_of_scenes_are_drawn_into_a_folder(tmp_path: Path) -> None:
    result = run(
        "scenes", "--scene", "empty", "--scene", "static-focus", "--units", "1",
        "--pictures", str(tmp_path / "new"), "--json",
    )  # fmt: skip
    assert result.exit_code == 0, result.output
    picture = tmp_path / "new" / "scene-static-focus.png"  # the empty scene shows nothing
    assert json.loads(result.stdout) == [str(picture)]
    assert picture.read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("scenes", "--scene", "magic"), "'magic' is not one of static-focus"),
        (("scenes", "--units", "2"), "--units"),
        (("scenes", "--units", "-1"), "--units"),
        (("scenes", "--seconds", "0"), "--seconds"),
        (("scenes", "--out", "/proc/nowhere/scenes.json"), "--out"),
        (("--quick", "scenes"), "after `scenes`"),
        (("magic",), "magic"),
    ],
)
def test_bad_arguments_of_scenes_are_told_before_the_work(
    arguments: tuple[str, ...], says: str
) -> None:
    result = run(*arguments)
    assert result.exit_code == 2
    assert says in result.stderr
