"""`pacinian serve`: the command itself; other tests cover the server."""

from __future__ import annotations

import errno
import io
import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from pacinian.cli import serve as module

if TYPE_CHECKING:
    from collections.abc import Callable

DEAF_ZONE = (
    "array = {type='autd', columns=1, rows=1}\n"
    "[[safety.zones]]\nposition = [0, 0, 0.6]\nradius = 0.4\npressure = 1e-9"
)


WRONG = [
    ("solver = {name='gs', options={nosuch=1}}", "solver", "no option of solver 'gs'"),
    ("solver = {name='gs', options={steps=-1}}", "solver", "`steps`"),
    ("solver = {name='lagrange', options={mu='x'}}", "solver", "`mu` must be a number"),
    ("backend = {name='simulated', options={nosuch=1}}", "backend", "no option of backend"),
    ("backend = {name='simulated', options={phases='x'}}", "backend", "`phases`"),
    ("rate = 1001", "rate", "must be 15.6 to 1000"),
    ("rate = 15", "rate", "must be 15.6 to 1000"),
    (DEAF_ZONE, "safety.zones", "nothing to sound with"),
]
STARTS = """
import sys
from pacinian.cli.main import main

for path in sys.argv[1:]:
    sys.argv[1:] = ["serve", path, "--quiet"]
    try:
        main()
    except SystemExit as end:
        print(end.code, flush=True)
"""


def test_settings_that_only_a_plug_in_can_check_end_the_start_by_file_and_key(
    tmp_path: Path,
) -> None:
    """One process starts all of these servers in turn, because most of the time is for its imports."""
    paths = [tmp_path / f"server{k}.toml" for k in range(len(WRONG))]
    for path, (text, _, _) in zip(paths, WRONG, strict=True):
        path.write_text(f"connection = 'c.json'\n{text}")
    command = [sys.executable, "-c", STARTS, *map(str, paths)]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.stdout.split() == ["2"] * len(WRONG), done.stderr
    lines = done.stderr.splitlines()
    for line, path, (_, key, words) in zip(lines, paths, WRONG, strict=True):
        assert line.startswith(f"error: {path}: $.{key}: ")
        assert words in line


@pytest.mark.deep
def test_wrong_settings_end_the_process_of_the_server(tmp_path: Path) -> None:
    path = tmp_path / "server.toml"
    path.write_text("connection = 'c.json'\nrate = 15")
    command = [sys.executable, "-m", "pacinian", "serve", str(path), "--quiet"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    (line,) = done.stderr.splitlines()
    assert line.startswith(f"error: {path}: $.rate: ")
    assert done.returncode == 2


def test_a_server_runs_although_its_output_cannot_be_written(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    ran: list[Path] = []

    def run(settings: object, ready: Callable[[Path], None], **_: object) -> None:
        ready(Path("connection.json"))
        ran.append(Path("connection.json"))

    def echo(text: str) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr("pacinian.serving.server.serve", run)
    monkeypatch.setattr("click.echo", echo)
    monkeypatch.setattr(sys, "stdout", io.StringIO())
    module.serve([], standalone_mode=False)
    assert ran
    assert sys.stdout is None, "at the end the interpreter does not try to write it again"
