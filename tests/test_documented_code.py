"""Check that the code in the README and its pages works as shown. Runs all code that needs a server."""

import json
import re
import runpy
import subprocess
import sys
import tomllib
from collections.abc import Iterator
from pathlib import Path

import pytest
import zmq

import pacinian as pc
from pacinian.client import link
from pacinian.client.reconnecting_client import ReconnectingClient
from pacinian.scene.config_sections import Units
from pacinian.serving.settings import Safety, Settings
from pacinian.testing import run_server
from pacinian.wire.connection_file import VARIABLE

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text()
PYTHON = re.compile(r"```python\n(.*?)```", re.DOTALL)
BLOCKS = PYTHON.findall(README)
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
SHOWN = [
    pytest.param(block, id=f"{page.relative_to(ROOT)}-{i}")
    for page in PAGES
    for i, block in enumerate(PYTHON.findall(page.read_text()))
]


def needs_server(block: str) -> bool:
    return "pc.Client(" in block or VARIABLE in block


# The server runs only for the last tests of this file, because it takes half of a core while it sounds.
SHOWN.sort(key=lambda shown: needs_server(str(shown.values[0])))


@pytest.fixture(scope="module")
def server() -> Iterator[str]:
    """Run a server whose limits are long, so that a machine that pauses for a moment ends nothing."""
    safety = Safety(lease=10.0, frame_timeout=1.0, hang_timeout=60.0, session_timeout=3600.0)
    with (
        run_server(Settings(array=Units(1, 1), safety=safety)) as running,
        pytest.MonkeyPatch.context() as patch,
    ):
        patch.setitem(ReconnectingClient.__init__.__kwdefaults__, "timeout", 60.0)
        for limit in (zmq.HEARTBEAT_TTL, zmq.HEARTBEAT_TIMEOUT):
            patch.setitem(link.HEARTBEAT, limit, 60_000)
        yield str(running.connection)


def test_its_first_example_makes_what_it_says(capsys: pytest.CaptureFixture[str]) -> None:
    namespace: dict[str, object] = {}
    exec(compile(BLOCKS[0], "README.md", "exec"), namespace)
    P = pc.radiation_pressure(namespace["p"], namespace["air"])  # type: ignore[arg-type]
    assert pytest.approx([20.0, 10.0], rel=1e-2) == P
    assert capsys.readouterr().out


def test_its_links_lead_somewhere() -> None:
    for page in PAGES:
        for target in re.findall(r"\]\((?!http)([^)#]+)\)", page.read_text()):
            assert (page.parent / target).exists(), f"{page.name}: {target}"


def test_its_badges_are_true_and_need_no_other_site() -> None:
    badges = re.findall(r"!\[([^\]]+)\]\(([^)]+badges[^)]+)\)", README)
    assert len(badges) >= 3
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    labels = {Path(file).stem: _label(ROOT / file) for _, file in badges}
    assert f">={labels['python'].split()[1]}" == project["requires-python"]
    assert labels["license"] == f"license: {project['license']}"
    for text, file in badges:
        assert text.lower() == _label(ROOT / file).lower()
        assert "http" not in (ROOT / file).read_text().replace("http://www.w3.org/2000/svg", "")


def _label(badge: Path) -> str:
    found = re.search(r"<title>(.*)</title>", badge.read_text())
    assert found
    return found[1]


def test_its_solver_is_short() -> None:
    (solver,) = (block for block in BLOCKS if "register_solvers" in block)
    assert len([line for line in solver.splitlines() if line.strip()]) <= 15


def test_the_example_plugin_installs_and_is_found(tmp_path: Path) -> None:
    """Install the plug-in with pip, into a folder."""
    subprocess.run(
        [sys.executable, "-m", "pip", "install", "--quiet", "--no-deps", "--no-build-isolation",
         "--disable-pip-version-check", "--target", str(tmp_path), str(ROOT / "examples/plane_wave")],
        check=True, capture_output=True, timeout=200,
    )  # fmt: skip
    code = (
        "import sys; sys.path.insert(0, sys.argv[1])\n"
        "import pacinian as pc, json\n"
        "s = pc.solve(pc.autd(), [[0, 0, .2]], [100.0], solver='plane-wave')\n"
        "o = pc.Plugins().find('solver', 'plane-wave')\n"
        "print(json.dumps([s.solver, o.distribution, float(abs(s.gains).min())]))"
    )
    done = subprocess.run(
        [sys.executable, "-c", code, str(tmp_path)],
        check=True, capture_output=True, text=True, timeout=200,
    )  # fmt: skip
    name, distribution, drive = json.loads(done.stdout)
    assert name == "plane-wave"
    assert "pacinian-plane-wave 0.1" in distribution
    assert drive == pytest.approx(1.0, abs=1e-5)


@pytest.mark.parametrize("block", SHOWN)
def test_its_python_runs(
    block: str,
    request: pytest.FixtureRequest,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    tmp_path: Path,
) -> None:
    monkeypatch.chdir(tmp_path)  # the examples write their files here
    (tmp_path / "examples").symlink_to(ROOT / "examples")
    if needs_server(block):
        monkeypatch.setenv(VARIABLE, request.getfixturevalue("server"))
    exec(compile(block, "page", "exec"), {"__name__": "readme"})
    if "print" in block:
        assert capsys.readouterr().out


def test_the_example_of_a_game_runs(
    server: str,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    tmp_path: Path,
) -> None:
    """It plays for a second, in which its ball rolls there and back once."""
    monkeypatch.setenv(VARIABLE, server)
    code = (ROOT / "examples/client.py").read_text()
    assert "RATE, SECONDS = 90.0, 5.0" in code
    (tmp_path / "client.py").write_text(code.replace("90.0, 5.0", "90.0, 1.0"))
    runpy.run_path(str(tmp_path / "client.py"))
    assert re.search(r"\d+ samples", capsys.readouterr().out)
