"""`pacinian status`, `stop` and `watch`, against a fake server."""

import itertools
import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import click
import numpy as np
import pytest
from click.testing import CliRunner

import pacinian as pc
from pacinian.cli.console import make_console
from pacinian.cli.status import make_table, status
from pacinian.cli.stop import stop
from pacinian.cli.watch import watch
from pacinian.client import server_session
from pacinian.wire import control, replies
from pacinian.wire.binary_arrays import pack
from pacinian.wire.state import ClientState, State

from ..client.fake_server import Fake, state

FULL: dict[str, Any] = {
    "output": "sounding", "armed": True, "owner": "game [1]", "scene": "hall",
    "points": pack([(0.0, 0.0, 0.2), (0.01, 0.0, 0.2)]), "asked": pack([5.0, 6.0]),
    "achieved": pack([5.0, 5.9]), "index": np.array([0, 0], "<i4").tobytes(),
    "normals": pack(np.zeros((2, 3))), "objects": ("ball",), "hands": pack(np.zeros((1, 26, 3))),
    "inputs": np.arange(4.0).tobytes(), "faults": ("late [x]",), "fault_count": 1,
    "skipped": {"nothing changed": 7}, "restarts": {"render": 1},
    "clients": (ClientState(name="game [1]", scene="hall", owner=True, objects=1, commands=9, errors=0,
                            dropped=0, age=0.001, renewed=0.01),),
}  # fmt: skip


@pytest.fixture(autouse=True)
def _patient(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(
        server_session, "BYE_TIMEOUT", 60.0
    )  # so that a slow server also gets the farewell


@pytest.fixture
def server() -> Iterator[Fake]:
    with Fake() as fake:
        yield fake


@pytest.fixture
def path(server: Fake, tmp_path: Path) -> str:
    return str(server.connection.write(tmp_path / "connection.json"))


def answer(server: Fake, **fields: Any) -> None:
    server.answers[control.Status] = lambda m: state(id=m.id, **fields)


def run(command: click.Command, *arguments: str, code: int = 0) -> str:
    result = CliRunner().invoke(command, list(arguments))
    assert result.exit_code == code, (result.output, result.exception)
    return result.stdout


def test_status_tells_all(server: Fake, path: str) -> None:
    answer(server, **FULL)
    seen = json.loads(run(status, "--connection", path, "--json"))
    assert seen["output"] == "sounding"
    assert seen["asked"] == [5.0, 6.0]
    assert np.shape(seen["points"]) == (2, 3)
    assert seen["inputs"] == [[0, 1, 2, 3]]
    assert set(seen) == {"silence"} | set(State.__struct_fields__) - {"id"}
    assert seen["silence"] is None
    text = run(status, "--connection", path)
    for word in (
        "sounding",
        "game [1]",
        "2 samples of 1 object, 1 hand",
        "late [x]",
        "7 nothing",
    ):
        assert word in text
    assert isinstance(server.seen[-1], control.Bye)


@pytest.mark.parametrize("command", [status, watch])
def test_silence_is_explained(command: click.Command, server: Fake, path: str) -> None:
    why = {"cause": "not armed", "why": "not armed: call arm()"}
    answer(server, **why)
    server.stream = lambda: state(**why)
    options = ("--seconds", "0") if command is watch else ()
    text = run(command, "--connection", path, *options)
    assert re.search(r"output\s+silent", text)
    assert re.search(r"why\s+not armed: call arm\(\)", text)
    seen = json.loads(run(command, "--connection", path, "--json", *options).splitlines()[0])
    assert seen["silence"] == {"cause": "not armed", "text": "not armed: call arm()"}


@pytest.mark.parametrize("no_color", [False, True])
def test_a_terminal_has_colours_unless_they_are_refused(
    no_color: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A pipe has no colours; `CliRunner` is not a terminal."""
    monkeypatch.setenv("FORCE_COLOR", "1")
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.delenv("NO_COLOR", raising=False)
    if no_color:
        monkeypatch.setenv("NO_COLOR", "1")
    console = make_console()
    with console.capture() as shown:
        console.print(make_table(state(**FULL)))
    green = re.search(r"\x1b\[[\d;]*32m", shown.get())
    assert bool(green) is not no_color


def test_names_that_clients_choose_cannot_move_the_cursor() -> None:
    console = make_console()
    with console.capture() as shown:
        console.print(make_table(state(**{**FULL, "owner": "\x1b[2J\r\nsilent"})))
    assert "\x1b[2J" not in shown.get()
    assert "?[2J??silent" in shown.get()


def test_a_pipe_has_neither_colours_nor_broken_sentences(
    server: Fake, path: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("COLUMNS", raising=False)
    fault = "the device went away " * 6
    answer(
        server,
        output="faulted",
        faults=(fault,),
        fault_count=1,
        cause="fault",
        why=f"fault: {fault}",
    )
    text = run(status, "--connection", path, code=1)
    assert "\x1b" not in text
    assert f"fault: {fault}".rstrip() in text.replace("\n", "")


def test_status_of_a_fault_is_exit_code_1(server: Fake, path: str) -> None:
    answer(server, output="faulted")
    run(status, "--connection", path, code=1)


def test_stop_needs_no_session(server: Fake, path: str) -> None:
    assert "stopped" in run(stop, "--connection", path)
    assert json.loads(run(stop, "--connection", path, "--json")) == {"stopped": True}
    assert [type(m) for m in server.seen] == [control.Stop] * 2


def test_a_stop_that_is_not_confirmed_is_an_error(server: Fake, path: str) -> None:
    server.answers[control.Stop] = lambda _: None
    result = CliRunner().invoke(stop, ["--connection", path, "--timeout", "0.1"])
    assert isinstance(result.exception, pc.ConnectionLost)
    assert "switch it off" in result.stderr
    server.answers[control.Stop] = lambda m: replies.Error(id=m.id, code="busy", message="no")
    result = CliRunner().invoke(stop, ["--connection", path])
    assert isinstance(result.exception, pc.Refused)
    server.answers[control.Stop] = lambda _: server.die()
    result = CliRunner().invoke(stop, ["--connection", path, "--timeout", "60"])
    assert isinstance(result.exception, pc.ConnectionLost)
    assert "has gone" in str(result.exception)


@pytest.mark.parametrize("command", [status, stop, watch])
def test_no_server_is_told(command: click.Command, tmp_path: Path) -> None:
    result = CliRunner().invoke(command, ["--connection", str(tmp_path / "none")])
    assert isinstance(result.exception, pc.ConnectionLost)
    assert "is `pacinian serve` running" in str(result.exception)


def test_watch_tells_a_line_for_each_state(server: Fake, path: str) -> None:
    numbers = itertools.count(1)
    server.stream = lambda: state(next(numbers), **FULL)
    lines = run(watch, "--connection", path, "--json", "--seconds", "0.1").splitlines()
    seen = [json.loads(line)["sequence"] for line in lines]
    assert seen
    assert seen == sorted(set(seen))
    assert server.of(control.Renew)  # the session continues
    assert "sounding" in run(watch, "--connection", path, "--seconds", "0")
