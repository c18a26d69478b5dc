"""Fixtures that are built once for all tests of the adapters."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

import pytest
from msgspec.structs import replace

from pacinian_lab.server.faults.server import Server

from ..core.client.fake_server import Fake
from . import tools
from .blockable_link import BlockableLink
from .game import HELD, RATE, Game, begin, sound, wait_until_free

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path


@pytest.fixture(scope="session")
def csharp_core(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the path of Pacinian.dll."""
    return tools.core(tmp_path_factory.mktemp("csharp"))


@pytest.fixture(scope="session")
def csharp_driver(csharp_core: Path) -> Path:
    """Return a game in C# that executes commands from standard input."""
    sources = [tools.CSHARP / "tests" / f"Client{name}.cs" for name in ("Driver", "Json")]
    return tools.csharp(csharp_core.with_name("ClientDriver.exe"), sources, csharp_core)


@pytest.fixture
def start(csharp_driver: Path) -> Callable[..., Game]:
    """Return a function that starts such a game; a module for another language replaces it."""
    return partial(begin, ["mono", "--debug", csharp_driver])


@pytest.fixture
def game(start: Callable[..., Game], file: Path) -> Iterator[Game]:
    """Return a connected game."""
    with start(file) as made:
        made.do("start")
        made.event("connected")
        yield made


@pytest.fixture
def server() -> Iterator[Fake]:
    """Return a fake server, whose answers the test sets."""
    with Fake() as fake:
        yield fake


@pytest.fixture
def wire(server: Fake) -> Iterator[BlockableLink]:
    """Return the transport of the commands to it."""
    with BlockableLink(server.connection.command) as link:
        yield link


@pytest.fixture
def file(server: Fake, wire: BlockableLink, tmp_path: Path) -> Path:
    """Return its connection file."""
    return replace(server.connection, command=wire.address).write(tmp_path / "connection.json")


@pytest.fixture(scope="module")
def real(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Server]:
    """Return a server of real processes, whose device records when it sounded."""
    with Server(tmp_path_factory.mktemp("server"), HELD, RATE) as made:
        yield made


@pytest.fixture
def player(
    real: Server, start: Callable[..., Game], request: pytest.FixtureRequest
) -> Iterator[Game]:
    """Return a game whose ball sounds. Its parameter: the lease that it requests [s]."""
    wait_until_free(real)
    with start(real.file, getattr(request, "param", 0.0)) as made:
        made.do("start")
        made.event("connected")
        sound(made)
        yield made
