"""ZMTP in C# without libzmq, against libzmq's own sockets, and against faulty, slow or hostile peers."""

from __future__ import annotations

import random
import threading
from contextlib import ExitStack
from pathlib import Path
from socket import create_connection
from typing import TYPE_CHECKING, Any

import pytest
import zmq
from zmq.auth.thread import ThreadAuthenticator

from ..waiting import PATIENCE, eventually
from . import tools
from .blockable_link import BlockableLink
from .game import Game
from .zmtp import Listener, command, frame, frames, greeting, ready

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    Start = Callable[..., Game]
    Bind = Callable[..., Any]

pytestmark = pytest.mark.deep("mono", "mcs")

TOKEN = "t" * 64
LARGEST = 1 << 20  # [bytes] of a message that the driver accepts
SIZES = (0, 1, 255, 256, 8191, 70_000, LARGEST)
DENIED, FOREIGN, GONE, NOBODY = "Denied", "Foreign", "Gone", "Nobody"


@pytest.fixture(scope="module")
def driver(tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = tmp_path_factory.mktemp("zmtp") / "ZmtpDriver.exe"
    tests = [tools.CSHARP / "tests" / f"{name}.cs" for name in ("ZmtpDriver", "ClientJson")]
    return tools.csharp(made, [*tools.CORE.rglob("*.cs"), *tests])


@pytest.fixture
def start(driver: Path) -> Start:
    def started(
        kind: str, address: str, token: str = "", ping: float = 0.0, timeout: float = PATIENCE, *,
        again: bool = False, handshake: float = PATIENCE,
    ) -> Game:  # fmt: skip
        times = str(ping), str(timeout), str(handshake)
        often = "again" if again else "once"
        return Game(["mono", "--debug", driver, kind, address, token, *times, often])

    return started


@pytest.fixture
def watchers() -> int:
    """Return the number of threads that wait for the bytes of an open socket."""
    return 1


@pytest.fixture
def bind() -> Iterator[Bind]:
    """Return a function that creates a socket of libzmq, with its address."""
    with ExitStack() as stack:
        context = stack.enter_context(zmq.Context())
        zap = ThreadAuthenticator(context)
        zap.start()
        stack.callback(zap.stop)
        zap.configure_plain("zmtp", {"pacinian": TOKEN})

        def bound(kind: int, *, plain: bool = False, port: str = "*", heartbeat: int = 0) -> Any:
            socket = stack.enter_context(context.socket(kind))
            socket.set_hwm(0)  # drops nothing
            socket.linger, socket.heartbeat_ivl = 0, heartbeat
            socket.heartbeat_timeout = int(1e3 * PATIENCE)
            socket.rcvtimeo = socket.sndtimeo = int(1e3 * PATIENCE)
            if plain:
                socket.plain_server, socket.zap_domain = True, b"zmtp"
            eventually(lambda: _binds(socket, f"tcp://127.0.0.1:{port}"))
            return socket, socket.get_string(zmq.LAST_ENDPOINT)

        yield bound


def _binds(socket: Any, address: str) -> bool:
    try:
        socket.bind(address)
    except zmq.ZMQError:
        return False
    return True


def pattern(count: int) -> bytes:
    return (bytes(i * 7 % 256 for i in range(256)) * (count // 256 + 1))[:count]


def digest(data: bytes) -> int:
    """Return the same digest as the driver."""
    total = 0
    for byte in data:
        total = (total * 31 + byte) % 1_000_003
    return total


def connected(game: Game) -> None:
    def has_room() -> bool:
        told = game.do("room")
        assert not [each for each in game.told if "ended" in each], game.told
        return bool(told["done"])

    eventually(has_room)


def received(game: Game) -> bytes:
    """Return the next message, which is short."""
    told = game.wait(lambda t: "received" in t)
    return bytes.fromhex(told["hex"])


def ended(game: Game) -> tuple[str, str]:
    told = game.wait(lambda t: "ended" in t)
    return told["ended"], told["problem"]


@pytest.mark.parametrize("plain", [False, True], ids=["NULL", "PLAIN"])
@pytest.mark.parametrize("kind", [zmq.ROUTER, zmq.DEALER], ids=["ROUTER", "DEALER"])
def test_messages_of_all_sizes_both_ways(bind: Bind, start: Start, kind: int, plain: bool) -> None:
    socket, address = bind(kind, plain=plain)
    with start("Dealer", address, TOKEN if plain else "") as game:
        connected(game)
        peer: list[bytes] = []
        for size in SIZES:
            assert game.do(f"large {size}")["done"]
            *peer, data = socket.recv_multipart()
            assert data == pattern(size)
            socket.send_multipart([*peer, data])
            told = game.wait(lambda t: "received" in t)
            assert (told["received"], told["sum"]) == (size, digest(data))
        socket.send_multipart([*peer, b"first", b"", b"last"])
        assert received(game) == b"last"
        for i in range(2000):
            socket.send_multipart([*peer, b"%d" % i])
        assert [received(game) for _ in range(2000)] == [b"%d" % i for i in range(2000)]
        assert game.end() == 0


@pytest.mark.parametrize("plain", [False, True], ids=["NULL", "PLAIN"])
def test_a_subscription_that_outlives_its_connections(
    bind: Bind, start: Start, watchers: int, plain: bool
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
        eventually(lambda: count_threads(game) == watchers)
        game.do("close")
        eventually(lambda: count_threads(game) == 0)


def test_ipv6(start: Start) -> None:
    with zmq.Context() as context, context.socket(zmq.ROUTER) as socket:
        socket.linger, socket.ipv6, socket.rcvtimeo = 0, True, int(1e3 * PATIENCE)
        try:
            socket.bind("tcp://[::1]:*")
        except zmq.ZMQError:
            pytest.skip("no IPv6 here")
        with start("Dealer", socket.get_string(zmq.LAST_ENDPOINT)) as game:
            connected(game)
            game.do("send hello")
            assert socket.recv_multipart()[1] == b"hello"


def count_threads(game: Game) -> int:
    """Return the number of threads that wait for bytes, by their name in the system."""
    names = Path(f"/proc/{game.process.pid}/task").glob("*/comm")
    return sum(name.read_text().startswith("Pacinian") for name in names)


def test_a_publisher(bind: Bind, start: Start) -> None:
    socket, address = bind(zmq.PUB, plain=True)
    with start("Sub", address, TOKEN, again=True) as game:
        game.do("subscribe state")
        ends = threading.Event()

        def publish() -> None:
            for i in range(10**9):
                socket.send_multipart([b"state", b"%d" % i])
                if ends.wait(0.001):
                    return

        thread = threading.Thread(target=publish)
        thread.start()
        try:
            first = int(received(game))
            assert [int(received(game)) for _ in range(100)] == list(range(first + 1, first + 101))
        finally:
            ends.set()
            thread.join()


def refuses(address: str) -> bool:
    """Return whether nobody listens at an address."""
    host, port = address.removeprefix("tcp://").rsplit(":", 1)
    try:
        create_connection((host, int(port)), PATIENCE).close()
    except ConnectionRefusedError:
        return True
    except ConnectionResetError:  # libzmq is just closing it
        return False
    return False


def test_who_is_refused(bind: Bind, start: Start) -> None:
    plain, at_plain = bind(zmq.ROUTER, plain=True)
    null, at_null = bind(zmq.ROUTER)
    publisher, at_publisher = bind(zmq.PUB)
    cases = [
        (at_plain, "", "mechanism"),
        (at_null, TOKEN, "mechanism"),
        (at_publisher, "", "type PUB"),
    ]
    for address, token, problem in cases:
        with start("Dealer", address, token) as game:
            how, why = ended(game)
            assert how == FOREIGN
            assert why == "" or problem in why  # libzmq may close the connection first
    with start("Dealer", at_plain, "x" * 64) as game:
        how, why = ended(game)
        assert (how, "400" in why) == (DENIED, True)
    for socket in (plain, null):
        assert not socket.poll(0)
    publisher.close()
    eventually(lambda: refuses(at_publisher))  # libzmq closes the port in its own thread
    with start("Dealer", at_publisher) as game:
        assert ended(game) == (NOBODY, "")


def test_heartbeats_go_both_ways(bind: Bind, start: Start) -> None:
    """Each side answers the other's heartbeats with their content."""
    router, address = bind(zmq.ROUTER, heartbeat=10)
    with BlockableLink(address) as line:
        heard: dict[str, bytes] = {"near": b"", "far": b""}
        line.tap = lambda side, data: heard.__setitem__(side, heard[side] + data)
        with start("Dealer", line.address, ping=0.01) as game:
            connected(game)

            def seen(side: str, name: bytes) -> int:
                return sum(
                    flags == 4 and body.startswith(name) for flags, body in frames(heard[side][64:])
                )

            for side in ("near", "far"):
                for name in (b"\4PING", b"\4PONG"):
                    eventually(lambda side=side, name=name: seen(side, name) > 20)  # type: ignore[misc]
            game.do("send still")
            assert router.recv_multipart()[1] == b"still"
            assert not [told for told in game.told if "ended" in told]


def test_what_is_too_large_ends_it(bind: Bind, start: Start) -> None:
    socket, address = bind(zmq.ROUTER)
    with start("Dealer", address) as game:
        connected(game)
        game.do("send here")
        peer, _ = socket.recv_multipart()
        socket.send_multipart([peer, bytes(LARGEST + 1)])
        how, why = ended(game)
        assert how == FOREIGN
        assert f"where at most {LARGEST}" in why


def test_one_that_goes(bind: Bind, start: Start, watchers: int) -> None:
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
        eventually(lambda: count_threads(game) == watchers)
        game.do("close")
        eventually(lambda: count_threads(game) == 0)
        assert game.end() == 0


def test_a_byte_at_a_time(start: Start) -> None:
    said = greeting() + ready() + command(b"PING", b"\0\0abc") + frame(b"a", 1) + frame(b"m" * 300)
    with (
        Listener() as listener,
        start("Dealer", listener.address) as game,
        listener.accept() as peer,
    ):
        peer.send_slowly(said)
        assert received(game) == b"m" * 40
        while (4, b"\4PONGabc") not in frames(peer.heard[64:]):
            assert peer.read()


@pytest.mark.parametrize("share", [0.0, 0.3, 0.6, 0.9, 1.0])
def test_cut_off_in_the_middle(start: Start, share: float) -> None:
    """The socket reports how it ended, and reconnects if it may."""
    hand = greeting() + ready(b"PUB")
    said = hand + frame(b"state" * 100)
    with (
        Listener() as listener,
        start("Sub", listener.address, again=True) as game,
    ):
        game.do("subscribe state")
        with listener.accept() as peer:
            peer.send(said[: int(share * (len(said) - 1))])
        with listener.accept() as peer:
            peer.send(said)
            told = game.wait(lambda t: "received" in t)
            assert told["received"] == 500


def test_one_that_never_answers_is_given_up(start: Start) -> None:
    with Listener() as listener:
        with start("Dealer", listener.address, handshake=0.5) as game, listener.accept():
            how, why = ended(game)
            assert (how, "takes too long" in why) == (FOREIGN, True)
        with start("Dealer", listener.address, "", 0.02, 0.5) as game, listener.accept() as peer:
            peer.greet()
            peer.expect(4, b"\4PING\0\5")  # tenths of seconds
            how, why = ended(game)
            assert (how, "silent" in why) == (GONE, True)
            game.do("close")
            while peer.read():  # until it is closed
                pass


def test_what_a_peer_does_not_read_is_bounded_and_then_arrives_whole(start: Start) -> None:
    size = 200_000
    with (
        Listener() as listener,
        start("Dealer", listener.address, ping=0.02) as game,
        listener.accept() as peer,
    ):
        peer.greet()
        connected(game)
        sent = list[bool]()

        def fill() -> bool:
            """Send until nothing more is taken; return whether there is still no room, as the system may make some."""
            while game.do(f"large {size}")["done"]:
                sent.append(True)
                assert len(sent) < 1000
            return not game.do("room")["done"]

        eventually(fill)
        got, count = 0, len(sent)
        while got < count:
            while found := frames(peer.heard):
                for flags, body in found:
                    if not flags & 4:
                        assert body == pattern(size)
                        got += 1
                peer.heard = peer.heard[sum(len(frame(b, f & ~2)) for f, b in found) :]
            if got < count:
                assert peer.read()
        eventually(lambda: game.do("room")["done"])
        peer.send(frame(b"well"))
        assert received(game) == b"well"


@pytest.mark.parametrize("seed", range(4))
def test_noise_over_tcp(start: Start, seed: int) -> None:
    choose = random.Random(seed)
    head = [b"", greeting(), greeting() + ready(), b"GET / HTTP/1.1\r\n\r\n"][seed]
    with Listener() as listener, start("Dealer", listener.address, ping=0.05) as game:
        with listener.accept() as peer:
            peer.send(head + bytes([choose.randrange(8, 256)]) + choose.randbytes(5000))
            assert ended(game)[0] == FOREIGN
        assert game.end() == 0


@pytest.mark.parametrize("seed", range(2))
def test_whatever_a_peer_sends(seed: int, tmp_path: Path) -> None:
    made = tmp_path / "ZmtpFuzz.exe"
    tools.csharp(made, [*tools.CORE.rglob("*.cs"), tools.CSHARP / "tests" / "ZmtpFuzz.cs"])
    said = tools.run("mono", "--debug", made, str(seed), "3000").splitlines()
    assert said[-1] == "3000 conversations"
    assert {"Gone after messages", "Foreign in the handshake", "Foreign after messages"} <= {
        line.partition(" ")[2] for line in said
    }
