"""A separate channel for the emergency stop, for programs on the server's machine: a datagram and its confirmation.

It needs no connection, so other clients cannot block it. An HMAC (RFC 2104) in both datagrams proves that the sender
has the secret of the connection file, without revealing it.
"""

from __future__ import annotations

import hashlib
import hmac
import secrets
import socket
import sys
import time
from contextlib import ExitStack, suppress
from pathlib import Path
from typing import Any

from pacinian.closeable import Closeable

NONCE_BYTES = 16  # size of a nonce, which is new for each stop [bytes]
DATAGRAM_BYTES = NONCE_BYTES + hashlib.sha256().digest_size  # size of a datagram [bytes]
RESEND_PERIOD = 0.1  # time after which an unconfirmed datagram is sent again [s]
LOOPBACK = "127.0.0.1"


def sign(secret: str, what: bytes, nonce: bytes) -> bytes:
    """Return a datagram: the nonce, and the HMAC of `what` and the nonce with the secret."""
    return nonce + hmac.digest(secret.encode(), what + nonce, "sha256")


def verify(secret: str, what: bytes, data: bytes) -> bytes:
    """Return the nonce of a datagram; empty if its HMAC is wrong."""
    return (
        data[:NONCE_BYTES]
        if hmac.compare_digest(data, sign(secret, what, data[:NONCE_BYTES]))
        else b""
    )


class StopSocket(Closeable):
    """The server's socket; a context manager. address: for the connection file. file: path of the socket (Unix)."""

    def __init__(self, file: Path, secret: str) -> None:
        self._secret = secret
        if sys.platform == "win32":
            self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
            self.socket.bind((LOOPBACK, 0))
            self.address = f"udp:{self.socket.getsockname()[1]}"
        else:
            self.socket = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
            self.socket.bind(str(file))  # in a private folder, so others cannot fill its queue
            self.address = f"unix:{file}"
        self.socket.setblocking(False)

    def receive(self) -> list[tuple[bytes, Any]]:
        """Return the requests since the last call, (nonce, sender). Call `confirm` once the output is silent."""
        found: list[tuple[bytes, Any]] = []
        with suppress(OSError):  # the queue is empty, or (on Windows) a sender has gone
            while True:
                data, peer = self.socket.recvfrom(DATAGRAM_BYTES + 1)
                if nonce := verify(self._secret, b"stop", data):
                    found.append((nonce, peer))
        return found

    def confirm(self, requests: list[tuple[bytes, Any]]) -> None:
        """Confirm requests to their senders."""
        for nonce, peer in requests:
            with suppress(OSError):
                self.socket.sendto(sign(self._secret, b"stopped", nonce), peer)

    def close(self) -> None:
        """Close the socket."""
        self.socket.close()


def request_stop(address: str, secret: str, timeout: float) -> bool:
    """Ask a server on this machine to stop. Returns whether it has confirmed the stop within `timeout` [s]."""
    nonce, due = secrets.token_bytes(NONCE_BYTES), time.perf_counter() + timeout
    with ExitStack() as stack:
        try:
            made = _connect(address, stack, nonce[:4].hex())
            while (left := due - time.perf_counter()) > 0.0:
                made.settimeout(min(left, RESEND_PERIOD))
                with suppress(TimeoutError):
                    made.send(sign(secret, b"stop", nonce))
                    if verify(secret, b"stopped", made.recv(DATAGRAM_BYTES + 1)) == nonce:
                        return True
            made.setblocking(False)  # the confirmation may have come while this process stood still
            return verify(secret, b"stopped", made.recv(DATAGRAM_BYTES + 1)) == nonce
        except (
            AttributeError,
            OSError,
            ValueError,
            OverflowError,
        ):  # no such sockets here, or no such server
            return False
    return False


def _connect(address: str, stack: ExitStack, name: str) -> socket.socket:
    """Return a connected socket that can receive an answer.

    Raises AttributeError, OSError, ValueError, OverflowError.
    """
    kind, _, at = address.partition(":")
    made = socket.socket(socket.AF_INET if kind == "udp" else socket.AF_UNIX, socket.SOCK_DGRAM)
    stack.callback(made.close)
    if kind == "udp":
        made.connect((LOOPBACK, int(at)))
        return made
    if sys.platform == "linux":
        made.bind("")  # an abstract address without a file: unix(7), autobind
    else:
        ours = Path(f"{at}-{name}")  # the path of a socket has 100 bytes at most
        stack.callback(ours.unlink, missing_ok=True)
        made.bind(str(ours))
    made.connect(at)
    return made
