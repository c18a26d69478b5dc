"""Commands say at once which extra they need, and need none for what they do not do."""

import importlib.util
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner

import pacinian as pc
from pacinian.cli.main import cli
from pacinian_lab.server import viewer

STUDY = Path(__file__).parents[3] / "examples" / "studies" / "arrangement.toml"
WITHOUT_PYARROW = """
import sys

sys.modules["pyarrow"] = None
from pacinian.cli.main import main

main()
"""


def test_bench_view_measures_nothing_without_the_viewer(monkeypatch: pytest.MonkeyPatch) -> None:
    found: Any = importlib.util.find_spec
    monkeypatch.setattr(
        importlib.util, "find_spec", lambda name: None if name == "uvicorn" else found(name)
    )
    monkeypatch.setattr(viewer, "measure", lambda *given: pytest.fail("it measures"))
    error = CliRunner().invoke(cli, ["bench", "view"]).exception
    assert isinstance(error, pc.MissingExtra)
    assert error.extra == "view"


@pytest.mark.parametrize(
    ("words", "code"),
    [(["--schema"], 0), (["--list", str(STUDY)], 0), (["--no-pictures", str(STUDY)], 2)],
    ids=["schema", "list", "run"],
)
def test_only_a_run_of_a_study_needs_pyarrow(words: list[str], code: int, tmp_path: Path) -> None:
    command = [sys.executable, "-c", WITHOUT_PYARROW, "study", *words]
    done = subprocess.run(
        command, cwd=tmp_path, capture_output=True, text=True, timeout=300, check=False
    )
    assert done.returncode == code, done.stderr
    assert ("pyarrow is not installed" in done.stderr) == bool(code)
    assert bool(done.stdout) != bool(code)
