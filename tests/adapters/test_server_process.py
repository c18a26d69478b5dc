"""Games in C++ and C#, and a stub of one in Unreal, start the server, which ends with them, or find another one."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING

import psutil
import pytest

from ..waiting import PATIENCE, eventually
from . import tools, unreal
from .game import Game, find_server

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

CPP = pytest.mark.deep("cmake", "ninja", "g++", "pkg-config")
CSHARP = pytest.mark.deep("mono", "mcs")
SERVER = str(Path(sys.executable).with_name("pacinian"))


def build_cpp() -> Path:
    """Return the folder with the game in C++ and the stub of one in Unreal."""
    unreal.generate(tools.CPP / "build" / "watched" / "headers")
    return tools.watched("client_server", "play")


@pytest.fixture
def file(tmp_path: Path) -> Path:
    return tmp_path / "connection.json"


@pytest.fixture(
    params=[
        pytest.param("cpp", marks=CPP, id="cpp"),
        pytest.param("csharp", marks=CSHARP, id="csharp"),
    ]
)
def start(request: pytest.FixtureRequest, file: Path) -> Iterator[Callable[..., Game]]:
    """Start a game with a server program; the folder of `file` is the one for temporary files."""
    program: list[str | Path] = (
        [build_cpp() / "core" / "client_server"] if request.param == "cpp" else []
    )
    if not program:
        core = request.getfixturevalue("csharp_core")
        sources = [tools.CSHARP / "tests" / f"Client{name}.cs" for name in ("Server", "Json")]
        program = ["mono", tools.csharp(core.with_name("ClientServer.exe"), sources, core)]
    games: list[Game] = []

    def begin(*command: str, log: str | None = None) -> Game:
        named = str(file.with_name(f"log{len(games)}")) if log is None else log
        words = command or (SERVER, "--quiet")
        environment = {**tools.environment(), "TMPDIR": str(file.parent)}
        games.append(Game([*program, file, named, *words], environment))
        return games[-1]

    yield begin
    for game in games:
        with game:
            if game.process.poll() is None:
                assert game.end() == 0, game.told[-20:]


def is_ours(game: Game, yes: bool) -> None:
    """Wait until it is connected to a server that it has started, or to another one."""
    told = game.until(lambda s: s["status"] and s["runs"] is yes)
    assert told["problem"] == ""


def test_the_server_ends_with_the_game_that_has_started_it_and_the_next_game_starts_another(
    start: Callable[..., Game], file: Path
) -> None:
    first = start()
    is_ours(first, True)
    second = start()
    is_ours(second, False)
    processes = find_server(file)
    assert len(processes) >= 4
    first.kill()
    assert not psutil.wait_procs(processes, PATIENCE)[1]
    is_ours(second, True)
    processes = find_server(file)
    second.say("stop")
    assert not psutil.wait_procs(processes, PATIENCE)[1]
    assert not file.exists()
    assert not second.until(lambda s: not s["status"])["runs"]


@pytest.mark.parametrize(
    ("command", "problem"),
    [
        (
            ("/nowhere/pacinian",),
            "/nowhere/pacinian",
        ),  # C++: "cannot be started"; C#: "was not found"
        ((SERVER, "--backend", "nonsense"), "exit code 2: error: no backend is called 'nonsense'"),
    ],
)
def test_why_there_is_no_server_is_told(
    start: Callable[..., Game], command: tuple[str, ...], problem: str
) -> None:
    assert not start(*command).until(lambda s: problem in s["problem"])["runs"]


def test_a_server_that_was_killed_is_told_apart(start: Callable[..., Game], tmp_path: Path) -> None:
    program = tmp_path / "pacinian"
    program.write_text("#!/bin/sh\nkill -9 $$\n")
    program.chmod(0o755)
    start(str(program)).until(lambda s: s["problem"] == "the server was killed (signal 9)")


def test_a_log_that_cannot_be_written_is_told(start: Callable[..., Game], tmp_path: Path) -> None:
    log = tmp_path / "missing" / "server.log"
    told = start(log=str(log)).until(lambda s: s["problem"] != "")
    assert told["problem"].startswith(f"the log {log} cannot be written: ")
    assert told["problem"].endswith("; create its folder, or give another path")
    assert not told["runs"]


@pytest.mark.parametrize("error", ["", "error: no device"])
def test_only_an_error_of_the_log_is_told(
    start: Callable[..., Game], tmp_path: Path, error: str
) -> None:
    program = tmp_path / "pacinian"
    lines = f"echo 'ready: c.json'\necho '{error}'\necho '[info] closed'\nexit 3\n"
    program.write_text("#!/bin/sh\nexec >&2\n" + lines)
    program.chmod(0o755)
    told = "the server has ended, with exit code 3" + (error and f": {error}")
    start(str(program)).until(lambda s: s["problem"] == told)


@pytest.mark.parametrize("start", [pytest.param("csharp", marks=CSHARP)], indirect=True)
def test_a_log_that_the_game_does_not_name_has_a_random_name_and_is_deleted(
    start: Callable[..., Game], tmp_path: Path
) -> None:
    game = start("/nowhere/pacinian", log="")
    game.until(lambda s: "was not found" in s["problem"])
    (log,) = tmp_path.glob("pacinian-*.log")
    assert len(log.stem) == len("pacinian-") + 32
    game.say("stop")
    eventually(lambda: not log.exists())


@CPP
def test_the_unreal_components_start_it_and_end_it(file: Path) -> None:
    with Game([build_cpp() / "play", file], tools.environment()) as game:
        game.do(f"serve {SERVER} --quiet")
        game.until(lambda s: s["status"] == "connected")
        processes = find_server(file)
        game.do("unserve")
        assert not psutil.wait_procs(processes, PATIENCE)[1]
        game.do("serve /nowhere/pacinian")
        told = game.until(lambda s: "cannot be started" in s["problem"])
        assert "install Pacinian, or give the program's full path" in told["problem"]
        assert told["silence"] == told["problem"]
        assert game.end() == 0, game.told[-20:]
