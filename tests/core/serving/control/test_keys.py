"""A server that accepts remote clients only with keys, on real sockets."""

from __future__ import annotations

import contextlib
from typing import TYPE_CHECKING, Any

import pytest
import zmq
import zmq.auth
from msgspec.structs import replace

from pacinian.serving.ipc.auth import make_client_keys, make_server_keys
from pacinian.serving.settings import Network, Security
from pacinian.wire.codec import encode
from pacinian.wire.control import Arm, Stop
from pacinian.wire.replies import Ok

from ..processes import PATIENT

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

PROTOCOL = "protocol", "handshake"  # depends on which side closes the connection first


@pytest.fixture
def keys(tmp_path: Path) -> Path:
    make_server_keys(tmp_path / "keys")
    return tmp_path / "keys"


@pytest.fixture
def curve(keys: Path, start_server: Any) -> Iterator[Any]:
    """Start a server on all addresses."""
    return start_server(
        replace(PATIENT, network=Network(host="0.0.0.0"), security=Security(str(keys)))
    )


def with_keys(server: Any, public: bytes, secret: bytes, **more: Any) -> Any:
    return server.client(curve_publickey=public, curve_secretkey=secret, **more)


def stranger(server: Any, public: bytes, secret: bytes, **more: Any) -> None:
    """Try an emergency stop with these keys."""
    with contextlib.suppress(zmq.Again):  # it may already be refused
        with_keys(server, public, secret, sndtimeo=0, **more).send(Stop())


def test_the_connection_file_holds_keys_that_do(curve: Any) -> None:
    assert curve.connection.token == ""
    assert curve.connection.control.startswith("tcp://127.0.0.1:")
    game = curve.client().hello()
    assert isinstance(game.ask(Arm), Ok)
    assert curve.states()().owner == "game"


def test_a_key_is_let_in_as_soon_as_it_is_listed_and_no_more_once_it_is_not(
    logged: Any, curve: Any, keys: Path
) -> None:
    public, secret = make_client_keys(keys, "tablet")
    known = zmq.auth.load_certificate(secret)
    with_keys(curve, *known).hello("tablet")
    public.unlink()
    stranger(curve, *known)
    logged.refused("key")
    assert curve.permit().stopped == 0


@pytest.mark.parametrize("who", ["unknown", "of another server", "without keys"])
def test_a_stranger_is_refused(logged: Any, curve: Any, who: str) -> None:
    if who == "without keys":
        bare = curve.sockets.enter_context(curve.context.socket(zmq.DEALER))
        bare.linger = 0
        bare.connect(curve.connection.control)
        with contextlib.suppress(zmq.Again):  # it may already have been refused
            bare.send(encode(Stop(id=1)), zmq.NOBLOCK)
    else:
        other = {"curve_serverkey": zmq.curve_keypair()[0]} if who == "of another server" else {}
        stranger(curve, *zmq.curve_keypair(), **other)
    logged.refused(*(("key",) if who == "unknown" else PROTOCOL))
    assert curve.permit().stopped == 0
