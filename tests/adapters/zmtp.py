"""Peers that speak ZMTP by hand, over sockets: the server's side of RFC 37 and 24."""

from __future__ import annotations

import socket
from contextlib import suppress
from typing import TYPE_CHECKING

from ..waiting import PATIENCE

if TYPE_CHECKING:
    from types import TracebackType

GREETING = 64  # [bytes]


def greeting(minor: int = 1, mechanism: bytes = b"NULL") -> bytes:
    return (
        b"\xff" + bytes(8) + b"\x7f\x03" + bytes([minor]) + mechanism.ljust(20, b"\0") + bytes(32)
    )


def frame(body: bytes, flags: int = 0) -> bytes:
    if len(body) < 256:
        return bytes([flags, len(body)]) + body
    return bytes([flags | 2]) + len(body).to_bytes(8, "big") + body


def command(name: bytes, data: bytes = b"") -> bytes:
    return frame(bytes([len(name)]) + name + data, 4)


def ready(kind: bytes = b"ROUTER") -> bytes:
    return command(b"READY", b"\x0bSocket-Type" + len(kind).to_bytes(4, "big") + kind)


def frames(data: bytes) -> list[tuple[int, bytes]]:
    """Return flags and bodies of whole frames; leave out a truncated one."""
    found: list[tuple[int, bytes]] = []
    while len(data) > 1:
        long = data[0] & 2
        head = 9 if long else 2
        size = int.from_bytes(data[1:head], "big")
        if len(data) < head + size:
            break
        found.append((data[0], data[head : head + size]))
        data = data[head + size :]
    return found


class Listener:
    """Accepts connections; a context manager. address: where."""

    def __init__(self) -> None:
        self._listener = socket.create_server(("127.0.0.1", 0))
        self._listener.settimeout(PATIENCE)
        self.address = f"tcp://127.0.0.1:{self._listener.getsockname()[1]}"

    def accept(self) -> Peer:
        return Peer(self._listener.accept()[0])

    def __enter__(self) -> Listener:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._listener.close()


class Peer:
    """One connection; a context manager. heard: what was read after the greeting."""

    def __init__(self, stream: socket.socket) -> None:
        self._stream = stream
        self._stream.settimeout(PATIENCE)
        self._stream.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self.heard = b""

    def send(self, data: bytes) -> None:
        self._stream.sendall(data)

    def send_slowly(self, data: bytes) -> None:
        """Send byte by byte."""
        for i in range(len(data)):
            self._stream.sendall(data[i : i + 1])

    def read(self) -> bool:
        """Read more bytes. Return whether there were any."""
        data = self._stream.recv(1 << 16)
        self.heard += data
        return bool(data)

    def greet(self, minor: int = 1, kind: bytes = b"ROUTER") -> None:
        """Run the whole handshake of NULL."""
        self.send(greeting(minor) + ready(kind))
        while len(self.heard) < GREETING:
            assert self.read()
        self.heard = self.heard[GREETING:]
        self.expect(4, b"\5READY")

    def expect(self, flags: int, body: bytes) -> bytes:
        """Read the next frame, which must have these flags and begin with these bytes."""
        while not (found := frames(self.heard)):
            assert self.read(), self.heard
        first = found[0]
        self.heard = self.heard[len(frame(first[1], first[0] & ~2)) :]
        assert (first[0], first[1][: len(body)]) == (flags, body)
        return first[1]

    def close(self) -> None:
        self._stream.close()

    def __enter__(self) -> Peer:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        with suppress(OSError):
            self._stream.close()
