"""`pacinian soak` and `pacinian bench bus`: what they print and their exit codes."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

from click.testing import CliRunner

from pacinian.bench.bus import latency, load, soak
from pacinian.cli import bench_bus
from pacinian.cli import soak as command

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    import pytest


def ran(what: Any, *arguments: str) -> Any:
    return CliRunner().invoke(what, list(arguments))


def test_a_short_soak_of_a_real_server(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(command, "SHORT", 4.0)
    result = ran(
        command.soak, "--short", "--units", "1", "--json", "--picture", str(tmp_path / "s.png")
    )
    assert result.exit_code in (0, 1), result.output  # the machine may be busy
    told = json.loads(result.stdout)
    assert len(told["rows"]) == 8
    events = dict[str, int]()
    for row in told["rows"]:
        assert row["memory"].keys() == {"control", "bus", "render", "guard"}
        for name, count in row["heard"]["events"].items():
            events[name] = events.get(name, 0) + count
    for name in (
        "come_and_go",
        "wrap",
        "swap",
        "join_or_leave",
        "nonsense",
        "dim",
        "pause",
        "emergency",
    ):
        assert events.pop(name) > 0
    assert not {name for name in events if name.startswith(("refused", "lost"))}
    assert told["rows"][-1]["heard"]["faults"] == told["rows"][-1]["heard"]["restarts"] == 0
    assert any(row["heard"]["sounding"] > 0.0 for row in told["rows"])
    assert (tmp_path / "s.png").exists()


def test_bad_arguments_are_refused() -> None:
    for what in (command.soak, bench_bus.bus):
        result = ran(what, "--units", "2")
        assert result.exit_code == 2
        assert "1, 4, 9" in result.stderr


def interrupted(*arguments: Any) -> Iterator[Any]:
    raise KeyboardInterrupt
    yield


def test_ctrl_c_keeps_what_there_is(monkeypatch: pytest.MonkeyPatch) -> None:
    for module in (soak, latency, load):
        monkeypatch.setattr(module, "measure", interrupted)
    for what in (command.soak, bench_bus.bus):
        result = ran(what, "--json")
        assert result.exit_code == 130
        assert json.loads(result.stdout)["interrupted"]
