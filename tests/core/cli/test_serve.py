"""`pacinian serve`: the command itself; other tests cover the server."""

from __future__ import annotations

import errno
import io
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from pacinian.cli import serve as module

if TYPE_CHECKING:
    from collections.abc import Callable

    import pytest


def test_a_server_runs_although_its_output_cannot_be_written(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    ran: list[Path] = []

    def run(settings: object, ready: Callable[[Path], None], ending: object) -> None:
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
