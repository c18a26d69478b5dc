"""A server that is reached from elsewhere, by keys only, on real sockets."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any

import pytest
import zmq
import zmq.auth

from pacinian.serving.security import make
from pacinian.serving.settings import Network, Security, Settings
from pacinian.wire.codec import encode
from pacinian.wire.control import Arm, Stop
from pacinian.wire.replies import Ok

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path

PROTOCOL = "protocol", "handshake"  # which of them, depends on who closes the connection first


def eventually(seen: Callable[[], Any], seconds: float = 10.0) -> Any:
    due = time.monotonic() + seconds
    while time.monotonic() < due:
        if value := seen():
            return value
        time.sleep(0.002)
    raise AssertionError("did not come true in time")


def refused(capfd: Any, *whys: str) -> None:
    """It is logged that a connection was refused, because of one of `whys`."""
    text = ""

    def seen() -> bool:
        nonlocal text
        text += capfd.readouterr().err
        return "connection refused" in text and any(f"why={why}" in text for why in whys)

    eventually(seen)


@pytest.fixture
def keys(tmp_path: Path) -> Path:
    make(tmp_path / "keys", "server", server=True)
    return tmp_path / "keys"


@pytest.fixture
def curve(keys: Path, start_server: Any) -> Iterator[Any]:
    """A server on all addresses."""
    return start_server(Settings(network=Network(host="0.0.0.0"), security=Security(str(keys))))


def with_keys(server: Any, public: bytes, secret: bytes, **more: Any) -> Any:
    return server.client(curve_publickey=public, curve_secretkey=secret, **more)


def test_the_connection_file_holds_keys_that_do(curve: Any) -> None:
    assert curve.connection.token == ""
    assert curve.connection.control.startswith("tcp://127.0.0.1:")
    game = curve.client().hello()
    assert isinstance(game.ask(Arm), Ok)
    assert curve.states()().owner == "game"


def test_a_key_is_let_in_as_soon_as_it_is_listed_and_no_more_once_it_is_not(
    capfd: Any, curve: Any, keys: Path
) -> None:
    public, secret = make(keys, "tablet")
    known = zmq.auth.load_certificate(secret)
    with_keys(curve, *known).hello("tablet")
    public.unlink()
    with_keys(curve, *known).send(Stop())
    refused(capfd, "key")
    assert curve.permit().stopped == 0


def test_unknown_keys_no_keys_and_another_servers_key_are_refused(capfd: Any, curve: Any) -> None:
    unknown = zmq.curve_keypair()
    with_keys(curve, *unknown).send(Stop())
    refused(capfd, "key")
    with_keys(curve, *unknown, curve_serverkey=zmq.curve_keypair()[0]).send(Stop())
    refused(capfd, *PROTOCOL)
    bare = curve.sockets.enter_context(curve.context.socket(zmq.DEALER))
    bare.linger = 0
    bare.connect(curve.connection.control)
    bare.send(encode(Stop(id=1)))
    refused(capfd, *PROTOCOL)
    assert curve.permit().stopped == 0
