"""To whom a client belongs, and how it finds its server."""

import pickle
import threading
from collections.abc import Iterator
from pathlib import Path

import pytest

import pacinian as pc

from .fake import Fake


@pytest.fixture
def server() -> Iterator[Fake]:
    with Fake() as fake:
        yield fake


@pytest.fixture
def client(server: Fake) -> Iterator[pc.Client]:
    with pc.Client(server.connection, name="test") as made:
        yield made


def test_it_belongs_to_one_thread(client: pc.Client) -> None:
    caught: list[BaseException] = []

    def other() -> None:
        for call in (client.clear, client.renew, client.stop, client.close):
            try:
                call()
            except pc.ServerError as error:
                caught.append(error)

    thread = threading.Thread(target=other)
    thread.start()
    thread.join()
    assert ["thread that made it" in str(error) for error in caught] == [True] * 4


def test_it_cannot_be_pickled(client: pc.Client) -> None:
    with pytest.raises(TypeError, match="one in each process"):
        pickle.dumps(client)


def test_closed_it_is_lost_for_good(server: Fake) -> None:
    client = pc.Client(server.connection, reconnect=True)
    client.close()
    client.close()
    assert not client.connected
    with pytest.raises(pc.ConnectionLost, match="closed"):
        client.clear()


def test_the_connection_file_is_found(
    server: Fake, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = server.connection.write(tmp_path / "here.json")
    with pc.Client(path) as client:
        assert client.connected
    monkeypatch.setenv("PACINIAN_CONNECTION", str(path))
    with pc.Client() as client:
        assert client.connected
    monkeypatch.setenv("PACINIAN_CONNECTION", str(tmp_path / "none"))
    with pytest.raises(pc.ConnectionLost, match="is `pacinian serve` running"):
        pc.Client()
