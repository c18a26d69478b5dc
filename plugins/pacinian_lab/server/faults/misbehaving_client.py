"""A client that may misbehave: it sends raw messages, as maps, over the usual sockets."""

from __future__ import annotations

import time
from collections import Counter
from typing import TYPE_CHECKING, Any

import msgspec
import zmq
from msgspec.structs import asdict

from pacinian.closeable import Closeable
from pacinian.wire.connection_file import Connection
from pacinian.wire.protocol import MAJOR, MINOR

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

Message = dict[str, Any]
USER = b"pacinian"
HEARTBEAT = 50  # [ms]


class Silent(TimeoutError):
    """No answer arrived in time."""


class MisbehavingClient(Closeable):
    """A client connected to the server of a connection file; a context manager.

    hide: replaces fields of the file, such as the token or an address. clock: the client's clock [s]. beats: use
    heartbeats on the control socket, as a game does, so that a lost connection ends. Raises ServerError if there is
    no server.
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
        self.received: list[Message] = []
        """Messages from the server, also unsolicited ones."""
        self.codes: Counter[str] = Counter()
        """Counts of all errors received, by code."""

    def _dealer(self, name: str, beats: bool) -> zmq.Socket[bytes]:
        made = self.context.socket(zmq.DEALER)
        prepare(made, self.file, beats=beats)
        made.connect(self.file[name])
        return made

    def hello(self, wait: float = 5.0, **more: Any) -> Message:
        """Say hello and return the answer, `welcome` or `error`."""
        fields = {"protocol": [MAJOR, MINOR], "client": "client", **more}
        reply = self.ask("hello", wait, **fields)
        self.session = reply.get("session", b"")
        return reply

    def ask(self, kind: str, wait: float = 2.0, **fields: Any) -> Message:
        """Send a request to the control socket and return its answer. Raises Silent."""
        self.say(kind, **fields)
        return self.answer(self.id, wait)

    def say(self, kind: str, **fields: Any) -> None:
        """Send a request to the control socket."""
        self.id += 1
        if kind not in ("hello", "stop"):
            fields.setdefault("session", self.session)
        send(self.control, {"type": kind, "id": self.id, **fields})

    def renew(self) -> None:
        """Renew the lease."""
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
        """Return the answer with this number within `wait` [s]. Keeps all messages in `received`. Raises Silent."""
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
        """Return the messages that have arrived on both sockets."""
        self.received.clear()
        for socket in (self.control, self.command):
            while socket.poll(0):
                self._read(socket)
        return list(self.received)

    def _read(self, socket: zmq.Socket[bytes]) -> Message:
        reply: Message = msgspec.msgpack.decode(socket.recv_multipart()[-1])
        if reply.get("type") == "error":
            self.codes[str(reply.get("code"))] += 1
        self.received.append(reply)
        del self.received[:-1000]
        return reply

    def close(self) -> None:
        """Close the sockets without saying bye."""
        self.control.close()
        self.command.close()
        self.context.term()


def prepare(socket: zmq.Socket[bytes], file: dict[str, Any], *, beats: bool = True) -> None:
    """Set the options and credentials of a client's socket."""
    socket.linger, socket.immediate = 0, True
    if beats:
        socket.heartbeat_ivl, socket.heartbeat_timeout = HEARTBEAT, 2 * HEARTBEAT
        socket.heartbeat_ttl = 4 * HEARTBEAT
        socket.rcvhwm = 0  # unlimited: at a limit, libzmq 4.3 aborts if a heartbeat is due
    if file["server_key"]:
        socket.curve_serverkey = file["server_key"].encode()
        socket.curve_publickey = file["public_key"].encode()
        socket.curve_secretkey = file["secret_key"].encode()
    elif file["token"]:
        socket.plain_username, socket.plain_password = USER, file["token"].encode()


def send(socket: zmq.Socket[bytes], message: Message) -> None:
    """Send a message, waiting up to 5 s for room. Raises Silent."""
    if not socket.poll(5000, zmq.POLLOUT):
        raise Silent("the server is not there")
    socket.send(msgspec.msgpack.encode(message))
