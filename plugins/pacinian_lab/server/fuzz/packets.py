"""Data for raw TCP connections: other protocols, older versions, truncated data, wrong lengths, noise."""

from __future__ import annotations

import contextlib
import socket
import struct
from typing import TYPE_CHECKING

from pacinian_lab.server.fuzz.mutations import encode

if TYPE_CHECKING:
    from random import Random

USER = b"pacinian"
WAIT = 0.5  # [s] for a step of the handshake
ANSWERS = {
    "wrong password": 64 + 1
}  # [bytes] to read before closing: a greeting, and the first byte of the refusal
SIGNATURE = b"\xff\0\0\0\0\0\0\0\x01\x7f"
HTTP = (
    b"GET / HTTP/1.1\r\nHost: localhost\r\n\r\n",
    b"GET /socket HTTP/1.1\r\nHost: localhost\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n\r\n",
    b"POST / HTTP/1.1\r\nHost: localhost\r\nContent-Length: 9\r\n\r\n\x01\0\x07\0hello",
    b"POST / HTTP/1.1\r\nContent-Length: 99999999999\r\nTransfer-Encoding: chunked\r\n\r\nFFFFFFFF\r\n",
    b"\x16\x03\x01\x02\0\x01\0\x01\xfc\x03\x03" + b"\0" * 200,  # TLS
    b"SSH-2.0-OpenSSH_9.2\r\n",
    b"*1\r\n$4\r\nPING\r\n",
)
STOP = encode({"type": "stop", "id": 1})


def encode_greeting(mechanism: bytes, major: int = 3, server: bool = False) -> bytes:
    """Return the first 64 bytes of ZMTP 3."""
    return SIGNATURE + bytes([major, 1]) + mechanism.ljust(20, b"\0") + bytes([server]) + b"\0" * 31


def frame(body: bytes, flags: int = 0) -> bytes:
    """Return a frame of ZMTP 2 and 3."""
    if len(body) < 256:
        return bytes([flags, len(body)]) + body
    return bytes([flags | 2]) + struct.pack(">Q", len(body)) + body


def command(name: bytes, body: bytes = b"") -> bytes:
    """Return a command of ZMTP 3."""
    return frame(bytes([len(name)]) + name + body, 4)


def hello(user: bytes, password: bytes) -> bytes:
    """Return the HELLO command of the PLAIN mechanism."""
    return command(b"HELLO", bytes([len(user)]) + user + bytes([len(password)]) + password)


def metadata(key: bytes, value: bytes) -> bytes:
    """Return one metadata property."""
    return bytes([len(key)]) + key + struct.pack(">I", len(value)) + value


INITIATE = command(b"INITIATE", metadata(b"Socket-Type", b"DEALER") + metadata(b"Identity", b""))
PLAIN = encode_greeting(b"PLAIN")


def packet(random: Random) -> tuple[str, bytes]:
    """Return a name and bytes from a peer that does not know the password."""
    noise = random.randbytes(random.choice([1, 8, 64, 300, 5000]))
    kinds: tuple[tuple[str, bytes], ...] = (
        ("nothing", b""),
        ("noise", noise),
        ("HTTP and others", random.choice(HTTP)),
        ("ZMTP 1.0", b"\x01\0" + bytes([len(STOP) + 1]) + b"\0" + STOP),
        ("ZMTP 1.0", b"\xff" + struct.pack(">Q", 2**63 - 1) + b"\0" + noise),
        ("ZMTP 2.0", SIGNATURE + b"\x01\x05\0\0" + frame(STOP)),
        ("ZMTP 2.0", SIGNATURE + b"\x01\x05\0\0\x02" + b"\xff" * 8 + noise),
        ("half a greeting", PLAIN[: random.randrange(64)]),
        ("NULL", encode_greeting(b"NULL") + command(b"READY", INITIATE[10:]) + frame(STOP)),
        ("CURVE", encode_greeting(b"CURVE") + command(b"HELLO", noise[:190])),
        ("unknown mechanism", encode_greeting(noise[:20])),
        ("future version", encode_greeting(b"PLAIN", 255) + noise),
        ("wrong password", PLAIN + hello(USER, noise[:64].hex()[:200].encode())),
        ("no password", PLAIN + INITIATE + frame(STOP)),
        ("wrong lengths", PLAIN + command(b"HELLO", b"\xff" + noise[:50])),
        ("long command", PLAIN + b"\x06" + struct.pack(">Q", random.choice([2**31, 2**63, 70_000])) + noise),
        ("server's words", encode_greeting(b"PLAIN", server=True) + command(b"WELCOME")),
        ("spoiled greeting", _flip(random, PLAIN) + hello(USER, b"x")),
    )  # fmt: skip
    return random.choice(kinds)


def within(random: Random) -> tuple[str, bytes]:
    """Return a name and bytes from a peer that knows the password, for use after the handshake."""
    noise = random.randbytes(random.choice([1, 8, 64, 300]))
    kinds: tuple[tuple[str, bytes], ...] = (
        ("in: length 2^63", b"\x02" + struct.pack(">Q", 2**63) + noise),
        ("in: length 4 GB", b"\x02" + struct.pack(">Q", 2**32) + noise),
        ("in: length 2 MB", b"\x02" + struct.pack(">Q", 1 << 21) + noise),
        ("in: many parts", frame(b"x", 1) * 500 + frame(STOP)),
        ("in: no last part", frame(b"x", 1) * 20),
        ("in: empty parts", frame(b"", 1) * 20 + frame(b"")),
        ("in: unknown flags", bytes([random.randrange(8, 256), 5]) + noise),
        ("in: unknown command", command(noise[:20], noise)),
        ("in: bad ping", command(b"PING", noise)),
        ("in: ping of 60 KB", command(b"PING", b"\0\x01" + b"x" * 60_000)),
        ("in: error", command(b"ERROR", noise)),
        ("in: again hello", hello(USER, b"x")),
        ("in: half a frame", b"\0\xff" + noise[:100]),
        ("in: noise", noise),
        ("in: subscribe", command(b"SUBSCRIBE", noise) + frame(b"\x01" + noise)),
    )
    return random.choice(kinds)


def _flip(random: Random, data: bytes) -> bytes:
    made = bytearray(data)
    made[random.randrange(len(made))] ^= 1 << random.randrange(8)
    return bytes(made)


def throw(address: str, data: bytes, token: bytes | None = None, answer: int = 0) -> bool:
    """Connect (with the password, if given), send, read `answer` bytes and close. Returns whether all of it worked."""
    host, port = address.removeprefix("tcp://").rsplit(":", 1)
    with socket.socket() as raw, contextlib.suppress(OSError):
        raw.settimeout(WAIT)
        # Close at once and leave no TIME_WAIT state behind.
        raw.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
        raw.connect((host, int(port)))
        if token is not None:
            raw.sendall(PLAIN + hello(USER, token))
            _read(raw, 64 + len(command(b"WELCOME")))
            raw.sendall(INITIATE)
            _read(raw, 2)
        raw.sendall(data)
        _read(raw, answer)
        if token is not None:
            raw.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 0, 0))
        return True
    return False


def _read(raw: socket.socket, size: int) -> None:
    while size > 0:
        size -= len(data := raw.recv(size))
        if not data:
            raise ConnectionError
