"""A server that is reached from elsewhere, by keys only, on real sockets."""

from __future__ import annotations

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
    from collections.abc import Iterator
    from pathlib import Path

PROTOCOL = "protocol", "handshake"  # which of them, depends on who closes the connection first


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
    logged: Any, curve: Any, keys: Path
) -> None:
    public, secret = make(keys, "tablet")
    known = zmq.auth.load_certificate(secret)
    with_keys(curve, *known).hello("tablet")
    public.unlink()
    with_keys(curve, *known).send(Stop())
    logged.refused("key")
    assert curve.permit().stopped == 0


def test_unknown_keys_are_refused(logged: Any, curve: Any) -> None:
    with_keys(curve, *zmq.curve_keypair()).send(Stop())
    logged.refused("key")
    assert curve.permit().stopped == 0


def test_another_servers_key_is_refused(logged: Any, curve: Any) -> None:
    other = zmq.curve_keypair()[0]
    with_keys(curve, *zmq.curve_keypair(), curve_serverkey=other).send(Stop())
    logged.refused(*PROTOCOL)
    assert curve.permit().stopped == 0


def test_who_has_no_keys_is_refused(logged: Any, curve: Any) -> None:
    bare = curve.sockets.enter_context(curve.context.socket(zmq.DEALER))
    bare.linger = 0
    bare.connect(curve.connection.control)
    bare.send(encode(Stop(id=1)))
    logged.refused(*PROTOCOL)
    assert curve.permit().stopped == 0
