"""A port of the kernel's vhci_hcd with something in it: the kernel asks by the messages of USB/IP, here are answers.

https://docs.kernel.org/usb/usbip_protocol.html. No daemon and no network: the kernel is given one end of a pair of
sockets. To it, and to all above it, this is a device on USB at high speed.
"""

from __future__ import annotations

import errno
import socket
import struct
import threading
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Callable

HOST = Path("/sys/devices/platform/vhci_hcd.0")
FREE, HIGH_SPEED = 4, 3  # of a port; of a device
UNLINK, SUBMITTED, UNLINKED = 2, 3, 4
# command, number, device, inwards, endpoint; flags, or whom to unlink; length, setup
COMMAND = struct.Struct(">5IIi12x8s")
REPLY = struct.Struct(">5Iii20x")  # the same five; status, length


class Transfer(NamedTuple):
    """What the kernel asks. setup: of endpoint 0: kind, request, value, index, length. data: sent to the device."""

    endpoint: int
    setup: tuple[int, int, int, int, int]
    data: bytes


class Answer(NamedTuple):
    """status: 0, or an errno below 0. length: bytes taken, or given as `data`."""

    status: int = 0
    length: int = 0
    data: bytes = b""


class Port:
    """The first free one; plugged in at once. answer: of a transfer; None: not at all, until the kernel gives up."""

    def __init__(self, answer: Callable[[Transfer], Answer | None]) -> None:
        self._answer = answer
        self._held: set[int] = set()
        self._socket, kernels = socket.socketpair()
        with kernels:  # the kernel keeps its own hold on it
            port = _free()
            told = f"{port} {kernels.fileno()} {0x10000 + port} {HIGH_SPEED}"
            (HOST / "attach").write_text(told)
        self._thread = threading.Thread(target=self._serve, daemon=True)
        self._thread.start()

    def pull(self) -> None:
        """Break the connection; also while a transfer is being answered."""
        with suppress(OSError):  # the kernel has done so
            self._socket.shutdown(socket.SHUT_RDWR)

    def close(self) -> None:
        """Unplug it."""
        self.pull()
        self._thread.join()
        self._socket.close()

    def _serve(self) -> None:
        with suppress(EOFError, OSError):
            while True:
                self._one()

    def _one(self) -> None:
        command = COMMAND.unpack(self._read(COMMAND.size))
        kind, number, _, inwards, endpoint, flags, length, setup = command
        if kind == UNLINK:
            status = -errno.ECONNRESET if flags in self._held else 0
            self._held.discard(flags)
            self._reply(UNLINKED, number, Answer(status))
            return
        data = b"" if inwards else self._read(length)
        answer = self._answer(Transfer(endpoint, struct.unpack("<BBHHH", setup), data))
        if answer is None:
            self._held.add(number)
        else:
            self._reply(SUBMITTED, number, answer)

    def _reply(self, kind: int, number: int, answer: Answer) -> None:
        head = REPLY.pack(kind, number, 0, 0, 0, answer.status, answer.length)
        self._socket.sendall(head + answer.data)

    def _read(self, length: int) -> bytes:
        data = b""
        while len(data) < length:
            if not (more := self._socket.recv(length - len(data))):
                raise EOFError
            data += more
        return data


def _free() -> int:
    for line in (HOST / "status").read_text().splitlines():
        hub, port, state, *_ = line.split()
        if hub == "hs" and int(state) == FREE:
            return int(port)
    raise AssertionError("all ports are taken")
