"""`pacinian soak` and `pacinian bench bus`: what they print of numbers that are made up, and their exit codes."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import pytest
from click.testing import CliRunner
from msgspec.structs import replace

from pacinian_lab.commands import bench_bus
from pacinian_lab.commands import soak as command
from pacinian_lab.server import latency, load, soak

from ..server.test_bus import windows

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path


def ran(what: Any, *arguments: str) -> Any:
    return CliRunner().invoke(what, list(arguments))


@pytest.mark.parametrize("faults", [0, 1])
def test_a_soak_is_told_in_json_and_drawn_and_its_exit_code_tells_of_a_missed_aim(
    faults: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    rows = windows(lambda k, row: replace(row, heard=replace(row.heard, faults=faults * (k // 20))))
    asked: list[tuple[int, float]] = []
    monkeypatch.setattr(soak, "measure", lambda *given: asked.append(given) or iter(rows))
    picture = tmp_path / "s.png"
    result = ran(command.soak, "--short", "--units", "4", "--json", "--picture", str(picture))
    assert result.exit_code == faults, result.output
    assert asked == [(2, command.SHORT)]
    told = json.loads(result.stdout)
    assert not told["interrupted"]
    assert len(told["rows"]) == len(rows)
    assert [one["met"] for one in told["targets"]].count(False) == faults
    assert picture.exists()


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
