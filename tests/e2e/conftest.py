"""One server for all tests of a file; a new one where the one before did not survive."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from pacinian.bench.faults.server import Server
from pacinian.bench.faults.stage import Stage

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator


@pytest.fixture(scope="module")
def settings() -> str:
    """TOML that is added to the server's: a lease that does not end where the machine is late."""
    return "[safety]\nlease = 10.0\n"


@pytest.fixture(scope="module")
def servers(
    settings: str, tmp_path_factory: pytest.TempPathFactory
) -> Iterator[Callable[[], Server]]:
    """Gives the running server; starts one if there is none, or it is not whole."""
    running: list[Server] = []

    def one() -> Server:
        if running and (running[-1].process.poll() is not None or len(running[-1].parts()) < 3):
            running.pop().close()
        if not running:
            server = Server(tmp_path_factory.mktemp("server"), settings)
            running.append(server)
            server.start()
        return running[-1]

    yield one
    for server in running:
        server.close()


@pytest.fixture
def stage(servers: Callable[[], Server]) -> Iterator[Stage]:
    """A server with a game to come."""
    with Stage(servers()) as made:
        yield made
