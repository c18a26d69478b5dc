"""A client without manners: raw messages as maps, over the sockets that any client has."""

from __future__ import annotations

import time
from collections import Counter
from typing import TYPE_CHECKING, Any

import msgspec
import zmq
from msgspec.structs import asdict

from pacinian.wire.connection import Connection
from pacinian.wire.protocol import MAJOR, MINOR

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path
    from types import TracebackType

Message = dict[str, Any]
USER = b"pacinian"
HEARTBEAT = 50  # [ms]


class Silent(TimeoutError):
    """No answer in time."""


class Peer:
    """Connected to the server of a connection file; a context manager.

    hide: takes the place of parts of the file, as another token or address. clock: its own [s]. beats: whether its
    link to control ends, as a game's, where it is not heard for a moment. Raises ServerError where there is no server.
    """

    def __init__(
        self,
        file: Path,
        *,
        clock: Callable[[], float] = time.perf_counter,
        beats: bool = False,
        **hide: str,
    ) -> None:
        self.file = {**asdict(Connection.read(file)), **hide}
        self.clock = clock
        self.context = zmq.Context()
        self.control = self._dealer("control", beats)
        self.command = self._dealer("command", False)
        self.session = b""
        self.sequence = self.id = 0
        self.told: list[Message] = []
        """What the server said unasked."""
        self.codes: Counter[str] = Counter()
        """Of all errors received."""

    def _dealer(self, name: str, beats: bool) -> zmq.Socket[bytes]:
        made = self.context.socket(zmq.DEALER)
        prepare(made, self.file, beats=beats)
        made.connect(self.file[name])
        return made

    def hello(self, wait: float = 5.0, **more: Any) -> Message:
        """Say hello; the answer is `welcome`, or `error`."""
        fields = {"protocol": [MAJOR, MINOR], "client": "peer", **more}
        reply = self.ask("hello", wait, **fields)
        self.session = reply.get("session", b"")
        return reply

    def ask(self, kind: str, wait: float = 2.0, **fields: Any) -> Message:
        """Ask the control socket, return its answer. Raises Silent."""
        self.say(kind, **fields)
        return self.answer(self.id, wait)

    def say(self, kind: str, **fields: Any) -> None:
        """Tell the control socket."""
        self.id += 1
        if kind not in ("hello", "stop"):
            fields.setdefault("session", self.session)
        send(self.control, {"type": kind, "id": self.id, **fields})

    def renew(self) -> None:
        """The game is alive."""
        self.sequence += 1
        self.say("renew", sequence=self.sequence, time=self.clock())

    def tell(self, kind: str, wait: float | None = None, **fields: Any) -> Message | None:
        """Send a command; with `wait` [s], return its answer. Raises Silent."""
        self.sequence += 1
        self.id += wait is not None
        number = self.id if wait is not None else 0
        base = {"session": self.session, "sequence": self.sequence, "time": self.clock()}
        send(self.command, {"type": kind, "id": number, **base, **fields})
        return None if wait is None else self.answer(number, wait, self.command)

    def answer(self, number: int, wait: float, socket: zmq.Socket[bytes] | None = None) -> Message:
        """The answer of that number within `wait` [s]; others are kept in `told`. Raises Silent."""
        socket = socket or self.control
        end = time.perf_counter() + wait
        while (left := end - time.perf_counter()) > 0.0:
            if not socket.poll(max(1, int(1e3 * left))):
                break
            reply = self._read(socket)
            if reply.get("id") == number:
                return reply
        raise Silent(f"no answer within {wait:g} s")

    def drain(self) -> list[Message]:
        """What has come since, from both sockets."""
        self.told.clear()
        for socket in (self.control, self.command):
            while socket.poll(0):
                self._read(socket)
        return list(self.told)

    def _read(self, socket: zmq.Socket[bytes]) -> Message:
        reply: Message = msgspec.msgpack.decode(socket.recv_multipart()[-1])
        if reply.get("type") == "error":
            self.codes[str(reply.get("code"))] += 1
        self.told.append(reply)
        del self.told[:-1000]
        return reply

    def close(self) -> None:
        """Away, without a word."""
        self.control.close()
        self.command.close()
        self.context.term()

    def __enter__(self) -> Peer:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()


def prepare(socket: zmq.Socket[bytes], file: dict[str, Any], *, beats: bool = True) -> None:
    """Options of a client's socket, with the credentials of a connection file."""
    socket.linger, socket.immediate = 0, True
    if beats:
        socket.heartbeat_ivl, socket.heartbeat_timeout = HEARTBEAT, 2 * HEARTBEAT
        socket.heartbeat_ttl = 4 * HEARTBEAT
        socket.rcvhwm = 0  # no limit: libzmq 4.3 ends the process if a heartbeat is due at one
    if file["server_key"]:
        socket.curve_serverkey = file["server_key"].encode()
        socket.curve_publickey = file["public_key"].encode()
        socket.curve_secretkey = file["secret_key"].encode()
    elif file["token"]:
        socket.plain_username, socket.plain_password = USER, file["token"].encode()


def send(socket: zmq.Socket[bytes], message: Message) -> None:
    """Send if it can be sent at once within 5 s. Raises Silent."""
    if not socket.poll(5000, zmq.POLLOUT):
        raise Silent("the server is not there")
    socket.send(msgspec.msgpack.encode(message))
