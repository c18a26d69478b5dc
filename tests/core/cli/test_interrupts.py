"""Ctrl-C during imports in the body of a command, which must neither lose it nor take it for an error of a module."""

from __future__ import annotations

import os
import subprocess
import sys
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from pathlib import Path

LIMIT = 60.0  # for a process to end [s]
SEND = "import os, signal\nos.kill(os.getpid(), signal.SIGINT)\n"
LOSE = f"""
try:
    exec({SEND!r})
except KeyboardInterrupt:
    pass
"""
TURN = f"""
try:
    exec({SEND!r})
except KeyboardInterrupt as error:
    raise ImportError("turned") from error
"""
SOLVER = """
import pacinian as pc

class Lost(pc.Solver):
    name = "lost"
    def solve(self, propagator, targets, limits, warm, budget, out):
        raise NotImplementedError

@pc.hookimpl
def register_solvers():
    return [Lost]
"""

pytestmark = pytest.mark.skipif(
    sys.platform == "win32", reason="Windows sends Ctrl-C to all of a console"
)


def end(folder: Path, *words: str) -> tuple[int, str, str]:
    """Run a command with the modules of `folder`; return its exit code and its stripped output."""
    done = subprocess.run(
        [sys.executable, "-m", "pacinian", *words],
        env={**os.environ, "PYTHONPATH": str(folder)},
        stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=LIMIT, check=False,
    )  # fmt: skip
    return done.returncode, done.stdout.strip(), done.stderr.strip()


@pytest.mark.parametrize("source", [LOSE, TURN], ids=["lost", "turned"])
@pytest.mark.parametrize(
    "words", [("plugins",), ("serve", "--quiet", "--solver", "lost")], ids=" ".join
)
def test_ctrl_c_while_a_plug_in_is_imported_ends_the_command(
    words: tuple[str, ...], source: str, tmp_path: Path
) -> None:
    entry = tmp_path / "losing-1.0.dist-info"
    entry.mkdir()
    (entry / "METADATA").write_text("Metadata-Version: 2.1\nName: losing\nVersion: 1.0\n")
    (entry / "entry_points.txt").write_text("[pacinian]\nlosing = losing\n")
    (tmp_path / "losing.py").write_text(source + SOLVER)
    code, out, err = end(tmp_path, *words)
    assert (code, err) == (130, "interrupted")
    assert "turned" not in out  # which would be a wrong diagnosis
    assert "ready" not in out


def test_doctor_does_not_take_ctrl_c_for_a_broken_library(tmp_path: Path) -> None:
    (tmp_path / "usb.py").write_text(TURN)
    code, out, err = end(tmp_path, "doctor")
    assert (code, err) == (130, "interrupted")
    assert "turned" not in out


def test_ctrl_c_ends_a_command_whose_import_never_ends(tmp_path: Path) -> None:
    (tmp_path / "usb.py").write_text(f"{SEND}import threading\nthreading.Event().wait()\n")
    code, _, err = end(tmp_path, "doctor")
    assert (code, err) == (130, "interrupted")
