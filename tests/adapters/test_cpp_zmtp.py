"""ZMTP in C++ under sanitizers: byte vectors, and all tests of the C# one."""

from __future__ import annotations

import inspect
from typing import TYPE_CHECKING

import pytest
import zmq

from ..waiting import PATIENCE
from . import test_csharp_zmtp, tools
from .game import Game
from .mutations import WIRE
from .test_csharp_zmtp import GONE, TOKEN, bind, connected, ended, received
from .zmtp import Listener, frame

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path
    from typing import Any

    Start = Callable[..., Game]
    Bind = Callable[..., Any]

pytestmark = pytest.mark.deep("cmake", "ninja", "g++", "pkg-config")

__all__ = ["bind"]  # a fixture

PURE = "zmtp_vectors", "zmtp_limits", "zmtp_standstill"
FUZZED = 1000  # conversations for each seed
OTHER = {  # tests only for C#, which subscribes later, has waiting threads, and has its own fuzzer
    "test_subscriptions", "test_a_peer_of_3_0_is_subscribed_to_by_messages", "test_one_that_goes",
    "test_whatever_a_peer_sends",
}  # fmt: skip

globals().update(
    {
        name: test
        for name, test in vars(test_csharp_zmtp).items()
        if name.startswith("test_") and inspect.isfunction(test) and name not in OTHER
    }
)


@pytest.fixture(scope="module")
def programs() -> Path:
    """Return the folder of the programs, which abort at invalid addresses and undefined behaviour."""
    targets = [*PURE, "zmtp_fuzz", "zmtp_answers"]
    return tools.cmake("sanitized", targets, "-DPACINIAN_SANITIZE=ON", tools.JOINED)


@pytest.fixture
def start(programs: Path) -> Start:
    def started(
        kind: str, address: str, token: str = "", ping: float = 0.0, timeout: float = PATIENCE, *,
        again: bool = False, handshake: float = PATIENCE,
    ) -> Game:  # fmt: skip
        often = "again" if again else "once"
        words = [kind, address, token, str(ping), str(timeout), str(handshake), often]
        return Game([programs / "zmtp_answers", *words])

    return started


@pytest.mark.parametrize("name", PURE)
def test_a_program_that_tests_itself(programs: Path, name: str) -> None:
    tools.run(programs / name, WIRE)


@pytest.mark.parametrize("seed", range(4))
def test_whatever_a_peer_sends(programs: Path, seed: int) -> None:
    said = tools.run(programs / "zmtp_fuzz", str(seed), str(FUZZED)).splitlines()
    assert said[-1] == f"{FUZZED} conversations"
    assert {"gone after messages", "foreign in the handshake", "foreign after messages"} <= {
        line.partition(" ")[2] for line in said
    }


@pytest.mark.parametrize("plain", [False, True], ids=["NULL", "PLAIN"])
def test_a_subscription_that_outlives_its_connections(
    bind: Bind, start: Start, plain: bool
) -> None:
    socket, address = bind(zmq.XPUB, plain=plain)
    with start("Sub", address, TOKEN if plain else "", again=True) as game:
        game.do("subscribe state")
        assert socket.recv() == b"\1state"
        for topic in (b"stat", b"other", b"state", b"state+"):
            socket.send_multipart([topic, b"of " + topic])
        assert [received(game) for _ in range(2)] == [b"of state", b"of state+"]
        port = address.rpartition(":")[2]
        for _ in range(3):
            socket.close()
            socket, _ = bind(zmq.XPUB, plain=plain, port=port)
            assert socket.recv() == b"\1state"
            socket.send_multipart([b"state", b"again"])
            assert received(game) == b"again"


def test_a_subscription_is_a_message_to_a_peer_of_3_0(start: Start) -> None:
    with Listener() as listener, start("Sub", listener.address, again=True) as game:
        game.do("subscribe state")
        with listener.accept() as peer:
            peer.greet(0, b"PUB")
            peer.expect(0, b"\1state")
            peer.send(frame(b"state", 1) + frame(b"it"))
            assert received(game) == b"it"


def test_one_that_goes(bind: Bind, start: Start) -> None:
    socket, address = bind(zmq.ROUTER)
    with start("Dealer", address) as game:
        connected(game)
        game.do("send here")
        peer, _ = socket.recv_multipart()
        socket.send_multipart([peer, b"last words"])
        socket.setsockopt(zmq.LINGER, -1)
        socket.close()
        assert received(game) == b"last words"
        assert ended(game) == (GONE, "")
        assert not game.do("send more")["done"]
        assert game.end() == 0
