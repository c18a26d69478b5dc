"""One server for all tests of a file; a new one where the one before did not survive."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from pacinian_lab.server.faults.server import Server

from ..core.client.long_timeouts import wait_long
from .game import Game

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

PATIENT = "[safety]\nlease = 10.0\nsession_timeout = 3600.0\nhang_timeout = 60.0\n"
"""Leases and watchdogs that do not end where the machine stands still."""


@pytest.fixture(autouse=True)
def patient(monkeypatch: pytest.MonkeyPatch) -> None:
    wait_long(monkeypatch)


@pytest.fixture(scope="module")
def servers(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Callable[[], Server]]:
    """Gives the running server; starts one if there is none, or it is not whole."""
    running: list[Server] = []

    def one() -> Server:
        if running and (running[-1].process.poll() is not None or len(running[-1].parts()) < 3):
            running.pop().close()
        if not running:
            running.append(Server(tmp_path_factory.mktemp("server"), PATIENT))
            running[-1].start()
        return running[-1]

    yield one
    for server in running:
        server.close()


@pytest.fixture
def server(servers: Callable[[], Server]) -> Server:
    return servers()


@pytest.fixture
def game(server: Server) -> Iterator[Game]:
    """It sounds."""
    with Game(server) as made:
        yield made
