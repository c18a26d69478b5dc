"""A fake server and its client; clients wait long, so that a stopped machine costs no connection."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

import pacinian as pc

from .fake_server import Fake
from .long_timeouts import wait_long

if TYPE_CHECKING:
    from collections.abc import Iterator


@pytest.fixture(autouse=True)
def patient(monkeypatch: pytest.MonkeyPatch) -> None:
    wait_long(monkeypatch)


@pytest.fixture
def server() -> Iterator[Fake]:
    with Fake() as fake:
        yield fake


@pytest.fixture
def client(server: Fake) -> Iterator[pc.Client]:
    with pc.Client(server.connection, name="test") as made:
        yield made
