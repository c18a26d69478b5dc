"""The client in C# from start to end: missing servers, rejected credentials, and stops."""

from __future__ import annotations

import os
import shutil
import socket
import sys
import tempfile
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest
import zmq
from msgspec.structs import replace

from pacinian.wire import control, replies
from pacinian.wire.connection_file import Connection
from pacinian.wire.stop_datagram import NONCE_BYTES, sign, verify

from ..core.client.fake_server import Fake, usual
from ..core.client.stopped_processes import server_apart, stand_still
from ..waiting import PATIENCE, eventually
from . import tools
from .game import Game, begin, fill

if TYPE_CHECKING:
    from collections.abc import Callable

    from .blockable_link import BlockableLink

    Start = Callable[..., Game]

pytestmark = pytest.mark.deep("mono", "mcs")

QUIET = 1.4  # [s], nearly as long as a link may be silent


@pytest.mark.parametrize("theirs", [0, 2])
def test_another_version_tells_which_side_to_update(
    server: Fake, file: Path, start: Start, theirs: int
) -> None:
    side = "server" if theirs < 1 else "client"
    if theirs:
        wrong = {"code": "version", "message": "protocol 2", "advice": f"update the {side}"}
        server.answers[control.Hello] = lambda m: replies.Error(id=m.id, **wrong)  # type: ignore[arg-type]
    else:
        server.answers[control.Hello] = lambda m: replace(usual(m), protocol=(0, 9))
    with start(file) as game:
        game.do("start")
        assert f"update the {side}" in game.until(lambda s: s["status"] == "Refused")["problem"]
        server.answers.clear()  # after an update
        game.event("connected")


def test_a_wrong_token_until_there_is_a_right_one(
    server: Fake, tmp_path: Path, start: Start
) -> None:
    wrong = replace(server.connection, token="x" * 64).write(tmp_path / "c.json")
    with start(wrong) as game:
        game.do("start")
        assert "token or key" in game.until(lambda s: s["status"] == "Refused")["problem"]
        assert server.seen == []
        server.connection.write(wrong)
        game.event("connected")
        assert game.status()["problem"] == ""


def test_the_content_of_a_connection_file_in_place_of_its_path(
    server: Fake, tmp_path: Path, start: Start
) -> None:
    """As on a headset: the server's process is on another machine, so that its number means nothing."""
    path = replace(server.connection, pid=2**22 + 1).write(tmp_path / "connection.json")
    with start(path.read_text(encoding="utf-8")) as game:
        game.do("start")
        game.event("connected")
        game.do("stop")
        server.until(lambda: bool(server.of(control.Stop)))
    with start('{"format": "another"}') as game:
        game.do("start")
        problem = game.until(lambda s: s["problem"] != "")["problem"]
        assert problem.startswith("the text of the connection is no connection file")


def test_where_nobody_is(tmp_path: Path, start: Start) -> None:
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        at = f"tcp://127.0.0.1:{free.getsockname()[1]}"
    path = tmp_path / "connection.json"
    with start(path) as game:
        game.do("start")
        says = "no connection file; is `pacinian serve` running, or still starting?"
        game.until(lambda s: says in s["problem"] and s["status"] == "Connecting")
        Connection(pid=2**22 + 1, control=at, command=at, state=at, token="x").write(path)
        game.until(lambda s: "has gone; is `pacinian serve` running" in s["problem"])
        Connection(pid=0, control=at, command=at, state=at, token="x").write(path)
        game.until(lambda s: "does not answer: is `pacinian serve` running" in s["problem"])
        Connection(pid=0, control=at, command=at, state=at).write(path)
        game.until(lambda s: "no token" in s["problem"])
        Connection(pid=0, control="nowhere", command=at, state=at, token="x").write(path)
        game.until(lambda s: "cannot connect to nowhere" in s["problem"])
        far = "tcp://192.0.2.1:5"  # where a token would be sent in clear text
        Connection(pid=0, control=far, command=far, state=far, token="x").write(path)
        game.until(lambda s: f"cannot connect to {far}" in s["problem"])
        path.write_text("[]")
        game.until(lambda s: "is no connection file" in s["problem"])
        if sys.platform == "linux":
            path.chmod(0o644)
            game.until(lambda s: "chmod 600" in s["problem"])
        with zmq.Context() as context, context.socket(zmq.ROUTER) as router:
            at = f"tcp://127.0.0.1:{router.bind_to_random_port('tcp://127.0.0.1')}"
            path.unlink()
            Connection(pid=0, control=at, command=at, state=at, token="x").write(path)
            problem = game.until(lambda s: s["status"] == "Refused")["problem"]
            assert "no Pacinian server" in problem
        assert [t for t in game.told if t.get("event") == "lost"] == []


def test_a_stop_has_a_way_of_its_own_and_is_told_where_it_is_not_confirmed(
    server: Fake, file: Path, start: Start
) -> None:
    with start(file, timeout=2.0) as game:
        game.do("stop")  # not started
        server.until(lambda: bool(server.of(control.Stop)))
        game.do("start")
        game.event("connected")
        held: list[Any] = []
        server.answers[control.Stop] = held.append
        game.do("stop")
        game.do("reset")
        server.until(lambda: bool(held))
        game.event("refused", "stop")
        server.until(lambda: bool(server.of(control.Reset)))  # after a limited wait


@pytest.mark.parametrize("kind", ["unix", "udp"])
def test_on_the_servers_machine_a_stop_needs_no_connection(
    tmp_path: Path, start: Start, kind: str
) -> None:
    nowhere, secret = "tcp://127.0.0.1:9", "s" * 64
    folder = Path(
        tempfile.mkdtemp(prefix="pacinian-")
    )  # the path of a socket has 100 bytes at most
    if kind == "udp":  # as on Windows
        receiver = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        receiver.bind(("127.0.0.1", 0))
        address = f"udp:{receiver.getsockname()[1]}"
    else:
        receiver = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        receiver.bind(str(folder / "stop"))
        address = f"unix:{folder / 'stop'}"
    with receiver:
        receiver.settimeout(PATIENCE)
        path = Connection(
            pid=os.getpid(), control=nowhere, command=nowhere, state=nowhere, token=secret, stop=address,
        ).write(tmp_path / "connection.json")  # fmt: skip
        with start(path, timeout=2.0 * PATIENCE) as game:
            game.do("stop")
            first, _ = receiver.recvfrom(100)
            again, peer = receiver.recvfrom(100)  # what is not confirmed is sent again
            assert again == first
            nonce = verify(secret, b"stop", first)
            assert len(nonce) == NONCE_BYTES
            receiver.sendto(sign("another", b"stopped", nonce), peer)  # this confirms nothing
            receiver.recvfrom(100)
            receiver.sendto(sign(secret, b"stopped", nonce), peer)
            eventually(lambda: is_closed(peer))  # it is confirmed, and not sent again
            assert [told for told in game.told if told.get("event") == "refused"] == []
    assert [file.name for file in folder.iterdir()] == ["stop"] * (kind == "unix")
    shutil.rmtree(folder)


def is_closed(peer: str | tuple[str, int]) -> bool:
    """Return whether nobody has the address of this datagram socket any more."""
    if isinstance(peer, str):
        return not Path(peer).exists()
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as other:
        try:
            other.bind(peer)
        except OSError:
            return False
    return True


@pytest.mark.parametrize("when", ["never started", "connecting", "connected", "unsent", "hangs"])
def test_the_end_waits_for_nobody(
    server: Fake, wire: BlockableLink, file: Path, start: Start, tmp_path: Path, when: str
) -> None:
    path = tmp_path / "none.json" if when == "connecting" else file
    with start(path) as game:  # has enough time for an answer
        if when != "never started":
            game.do("start")
        if when not in {"never started", "connecting"}:
            game.event("connected")
        if when == "unsent":
            fill(server, game, wire)
        if when == "hangs":
            server.deaf = True
        for _ in range(2):  # the second call does nothing
            game.do("dispose")
        assert game.status()["status"] == "Stopped"
        for line in ("start", "put ball 0 0 0.2 5", "clear", "arm", "stop"):
            game.do(line)
        assert game.end() == 0
    if when == "connected":
        server.until(lambda: bool(server.of(control.Bye)))


def answered(game: Game) -> None:
    """Send the server a request, and wait for its answer, or until there will be none."""
    if game.do("field at 0 0 0.2")["done"]:
        game.wait(lambda told: "field" in told)


@pytest.mark.skipif(sys.platform == "win32", reason="needs SIGSTOP")
@pytest.mark.parametrize("who", ["server", "game"])
def test_neither_side_is_lost_that_stands_still_for_a_moment(
    start: Start, tmp_path: Path, who: str
) -> None:
    """A trial in which the link may have been silent for too long does not count: try again."""
    with (
        server_apart() as (server, connection),
        start(connection.write(tmp_path / "c.json")) as game,
    ):
        game.do("start")
        end, quiet = time.monotonic() + PATIENCE, QUIET
        while quiet >= QUIET:
            assert time.monotonic() < end, "the machine is too busy"
            game.until(lambda s: s["status"] == "Connected")
            lost = [told for told in game.told if told.get("event") == "lost"]
            begin = time.monotonic()
            answered(game)
            stand_still(server if who == "server" else game.process)
            answered(game)
            quiet = time.monotonic() - begin
        assert [told for told in game.told if told.get("event") == "lost"] == lost


def test_one_that_is_forgotten_says_goodbye(server: Fake, game: Game) -> None:
    game.do("forget")
    server.until(lambda: bool(server.of(control.Bye)))


def test_its_domain_can_be_unloaded_as_an_editor_does(
    server: Fake, file: Path, csharp_core: Path
) -> None:
    sources = [tools.CSHARP / "tests" / "ClientDomain.cs"]
    program = tools.csharp(csharp_core.with_name("ClientDomain.exe"), sources, csharp_core)
    said = tools.run("mono", "--debug", program, file, limit=60.0)
    assert said.split() == ["connected", "unloaded", "connected", "unloaded"]
    assert len(server.of(control.Hello)) == 2


def with_library_of_wheel(driver: Path, folder: Path) -> list[str | Path]:
    """The driver in a folder with pyzmq's own libzmq, as the Unity package copies it. Skips if pyzmq has none."""
    libraries = Path(zmq.__file__).parents[1] / "pyzmq.libs"
    for library in libraries.glob("*.so*") if libraries.exists() else ():
        name = "libzmq.so" if library.name.startswith("libzmq") else library.name
        shutil.copy(library, folder / name)
    if not (folder / "libzmq.so").exists():
        pytest.skip("pyzmq was built with a libzmq of the system")
    for name in ("Pacinian.dll", "ClientDriver.exe"):
        shutil.copy(driver.with_name(name), folder)
    return ["mono", "--debug", folder / "ClientDriver.exe"]


@pytest.mark.parametrize("of", ["system", "wheel"])
def test_keys_in_place_of_a_token(csharp_driver: Path, tmp_path: Path, of: str) -> None:
    public, secret = zmq.curve_keypair()
    ours, our_secret = zmq.curve_keypair()
    keys = {"public_key": ours.decode(), "secret_key": our_secret.decode()}
    program: list[str | Path] = ["mono", "--debug", csharp_driver]
    if of == "wheel":
        program = with_library_of_wheel(csharp_driver, tmp_path)
    with Fake(keys=(public, secret)) as server:
        path = replace(server.connection, token="", **keys).write(tmp_path / "connection.json")
        with begin(program, path) as game:
            game.do("start")
            game.event("connected")
            mapped = Path(f"/proc/{game.process.pid}/maps")
            if of == "wheel" and mapped.exists():
                assert f"{tmp_path}/libzmq.so" in mapped.read_text()
            replace(server.connection, token="", **{**keys, "server_key": ours.decode()}).write(
                path
            )
            server.say(replies.Error(code="session", message="again"))
            assert game.until(lambda s: s["status"] == "Refused")["problem"]


@pytest.mark.parametrize("by", ["PACINIAN_CONNECTION", "XDG_RUNTIME_DIR", "TMPDIR"])
def test_where_the_connection_file_is(server: Fake, tmp_path: Path, start: Start, by: str) -> None:
    folder = tmp_path / f"runtime-{os.getuid()}" if by == "TMPDIR" else tmp_path
    path = server.connection.write(folder / "pacinian" / "connection.json")
    where = {"PACINIAN_CONNECTION": "", "XDG_RUNTIME_DIR": "", by: str(tmp_path)}
    if by == "PACINIAN_CONNECTION":
        where[by] = str(path)
    elif sys.platform != "linux":
        pytest.skip("folders of Linux")
    elif by == "TMPDIR" and Path(f"/run/user/{os.getuid()}/pacinian/connection.json").exists():
        pytest.skip("a server of this user runs: its file comes first")
    with start(**where) as game:
        game.do("start")
        game.event("connected")


def test_libzmq_is_needed_only_for_keys(csharp_driver: Path, server: Fake, tmp_path: Path) -> None:
    for name in ("Pacinian.dll", "ClientDriver.exe"):
        (tmp_path / name).write_bytes(csharp_driver.with_name(name).read_bytes())
    config = '<configuration><dllmap dll="libzmq" target="libnone.so.5"/></configuration>'
    (tmp_path / "Pacinian.dll.config").write_text(config)
    (public, _), (ours, secret) = zmq.curve_keypair(), zmq.curve_keypair()
    keys = {"server_key": public, "public_key": ours, "secret_key": secret}
    decoded = {name: key.decode() for name, key in keys.items()}
    path = replace(server.connection, token="", **decoded).write(tmp_path / "connection.json")
    with Game(["mono", "--debug", tmp_path / "ClientDriver.exe", path, "0", "1", "2"]) as game:
        game.do("start")
        problem = game.until(lambda s: "libzmq" in s["problem"])["problem"]
        assert "Window > Pacinian > Server" in problem  # says what to do
        game.do("stop")
        assert "libzmq" in game.event("refused", "stop")["message"]
        server.connection.write(path)
        game.event("connected")
        game.do("stop")
        server.until(lambda: bool(server.of(control.Stop)))
        assert game.end() == 0
