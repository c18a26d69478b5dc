"""The thread that owns a client, and how a client finds its server."""

import pickle
import threading
from pathlib import Path
from typing import Any

import pytest
from msgspec.structs import replace

import pacinian as pc
from pacinian.wire import control, replies

from .fake_server import Fake


def test_it_belongs_to_one_thread(client: pc.Client) -> None:
    caught: list[BaseException] = []

    def other() -> None:
        for call in (client.clear, client.renew, client.disarm, client.close):
            try:
                call()
            except pc.ServerError as error:
                caught.append(error)

    thread = threading.Thread(target=other)
    thread.start()
    thread.join()
    assert ["thread that made it" in str(error) for error in caught] == [True] * 4


def test_a_stop_is_of_any_thread_and_does_not_disturb_the_session(
    server: Fake, client: pc.Client
) -> None:
    caught: list[BaseException] = []

    def other() -> None:
        try:
            client.stop()
        except BaseException as error:
            caught.append(error)

    for _ in range(2):
        thread = threading.Thread(target=other)
        thread.start()
        while thread.is_alive():
            client.clear()
    assert caught == []
    assert len(server.of(control.Stop)) == 2
    client.stop()
    assert len(server.of(control.Hello)) == 1
    assert len(server.of(control.Stop)) == 3


def test_a_stop_after_close_is_done_with_the_same_arguments(
    server: Fake, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with pc.Client(server.connection.write(tmp_path / "connection.json"), timeout=99.0) as client:
        pass
    client.stop()
    assert isinstance(server.seen[-1], control.Stop)
    seen: list[Any] = []

    def instead(where: object, *, timeout: float, keys: object) -> None:
        seen.append((where, timeout, keys))

    monkeypatch.setattr("pacinian.client.client.emergency_stop", instead)
    client.stop()
    assert seen == [(tmp_path / "connection.json", 99.0, None)]


def test_a_stop_that_the_session_is_refused_is_tried_without(
    server: Fake, client: pc.Client
) -> None:
    answers = [replies.Error(code="busy", message="too much"), replies.Ok()]
    server.answers[control.Stop] = lambda m: replace(answers.pop(0), id=m.id)
    client.stop()
    assert answers == []


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
