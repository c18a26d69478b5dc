"""Authentication: the security mechanism of all the server's sockets, and its keys.

On loopback, the mechanism is PLAIN, with a token that is new at each start; elsewhere it is CURVE, with an allow-list.
Both go through ZAP. Therefore no byte from an unauthorised program, such as a browser or a port scanner, is ever
decoded.
"""

from __future__ import annotations

import logging
import os
import tempfile
import threading
from pathlib import Path
from typing import TYPE_CHECKING, Any

import zmq
from zmq.auth import create_certificates, load_certificate

from pacinian.errors import ArgumentError, ServerError
from pacinian.serving.ipc.zap import ZapThread
from pacinian.wire.connection_file import Connection

if TYPE_CHECKING:
    from pacinian.serving.settings import Settings

DOMAIN = "pacinian"
USER = "pacinian"
HANDSHAKE_TIMEOUT = 2000  # time limit for the handshake [ms]
# Time after which unacknowledged data ends a connection [ms]. This uses a TCP option, not ZeroMQ
# heartbeats: libzmq 4.3 aborts (`!_io_error`) if a heartbeat is due on a connection that was closed
# while its messages waited at the high-water mark.
MAX_UNACKNOWLEDGED_TIME = 500
# High-water mark: largest number of queued messages to or from one client. A longer queue only makes messages older.
MAX_QUEUED_MESSAGES = 256
BACKLOG = 128  # largest number of connections that may wait to be accepted
# Largest number of parts of a message that are skipped before other work is done. They take some 10 ms.
MAX_SKIPPED = 5000


def make_secrets(settings: Settings) -> dict[str, str]:
    """Make the secrets of one run for all processes that bind sockets.

    Returns a token, or the keys of the server and of one local client. Raises ServerError.
    """
    if settings.network.loopback and not settings.security.keys:
        return {"token": os.urandom(32).hex()}
    public, secret = _read_pair(Path(settings.security.keys) / "server.key_secret")
    local, local_secret = zmq.curve_keypair()
    return {
        "server_key": public,
        "server_secret": secret,
        "public_key": local.decode(),
        "secret_key": local_secret.decode(),
    }


class ClientAuthenticator:
    """Authenticates clients by the secrets. A context manager; enter it before any socket is bound.

    given: the secrets from `make_secrets`. keys: the folder of keys. A change of its folder `clients` applies from the
    next connection on.
    """

    def __init__(self, context: zmq.Context[Any], given: dict[str, str], keys: str = "") -> None:
        self._secrets, self._clients = given, Path(keys) / "clients"
        self._names: dict[bytes, str] = {}
        self._stamp: tuple[tuple[str, int, int], ...] = ()
        log = logging.getLogger("pacinian.zap")
        log.setLevel(logging.INFO)  # lower levels would log the token
        self._zap = ZapThread(context, log)
        self._lock = threading.Lock()
        self._unknown: list[str] = []

    def __enter__(self) -> ClientAuthenticator:
        self._zap.start()
        if token := self._secrets.get("token"):
            self._zap.rules.configure_plain(DOMAIN, {USER: token})
        else:
            self._zap.rules.configure_curve_callback(DOMAIN, self)
        return self

    def __exit__(self, *_: object) -> None:
        self._zap.stop()

    def configure_socket(self, socket: zmq.Socket[Any], longest: int) -> None:
        """Set all options of a socket, its authentication included, before `bind`. longest: limit on a message [bytes].

        `rcvbuf` stays at the system's default: 16 KiB halved the throughput of one client.
        """
        options = {
            zmq.LINGER: 0,
            zmq.MAXMSGSIZE: longest,
            zmq.HANDSHAKE_IVL: HANDSHAKE_TIMEOUT,
            zmq.RCVHWM: MAX_QUEUED_MESSAGES,
            zmq.SNDHWM: MAX_QUEUED_MESSAGES,
            zmq.BACKLOG: BACKLOG,
            zmq.IPV6: 1,
            zmq.TCP_MAXRT: MAX_UNACKNOWLEDGED_TIME,
        }
        if socket.getsockopt(zmq.TYPE) == zmq.ROUTER:
            options[zmq.ROUTER_MANDATORY] = 1
        for option, value in options.items():
            socket.setsockopt(option, value)
        socket.zap_domain = DOMAIN.encode()
        if "token" in self._secrets:
            socket.plain_server = True
        else:
            socket.curve_server = True
            socket.curve_publickey = self._secrets["server_key"].encode()
            socket.curve_secretkey = self._secrets["server_secret"].encode()

    def callback(self, domain: str, key: bytes) -> bool:
        """Return whether the client with this public key (Z85) may connect. The authenticator's thread calls this."""
        del domain
        if key == self._secrets["public_key"].encode():
            return True
        known = key in self._read_client_keys()
        if not known:
            with self._lock:
                self._unknown = [*self._unknown[-15:], key.decode()]
        return known

    def name_user(self, user: str) -> str:
        """Return the name of the client whose `User-Id` is `user`: that of its key file, "local", or `user` itself."""
        if user == self._secrets.get("public_key"):
            return "local"
        return self._names.get(user.encode(), user)

    def take_unknown_keys(self) -> list[str]:
        """Return the public keys that were refused since the last call, at most 16."""
        with self._lock:
            seen, self._unknown = self._unknown, []
        return seen

    def _read_client_keys(self) -> dict[bytes, str]:
        """Return the names of the clients by their public keys; empty if the folder cannot be read."""
        try:
            files = sorted(self._clients.glob("*.key"))
        except OSError:
            files = []
        stamp = tuple((file.name, *_stamp(file)) for file in files)
        if stamp != self._stamp:
            self._names = {_read_public(file): file.stem for file in files}
            self._names.pop(b"", None)
            self._stamp = stamp
        return self._names


def receive(socket: zmq.Socket[Any]) -> tuple[bytes, str, bytes] | None:
    """Return the next message of a ROUTER socket as peer, `User-Id`, message; None if there is none.

    The message is empty unless it was a single part. A message of too many parts counts as none; each call skips some
    of them, so that its receiver can do other work in between. Reading part by part takes a third of the time of
    `recv_multipart`.
    """
    try:
        if socket.getsockopt(zmq.RCVMORE) and not _skip_parts(socket):
            return None
        peer = socket.recv(zmq.NOBLOCK)
        frame = socket.recv(zmq.NOBLOCK, copy=False)
        data = frame.bytes
        if frame.more:
            data = b""
            if not _skip_parts(socket):
                return None
    except zmq.Again:
        return None
    try:
        return peer, str(frame.get("User-Id")), data
    except zmq.ZMQError:
        return peer, "", data


def _skip_parts(socket: zmq.Socket[Any]) -> bool:
    """Skip the other parts of a message, but only so many; return whether the message has ended."""
    return any(not socket.recv(zmq.NOBLOCK, copy=False).more for _ in range(MAX_SKIPPED))


def make_server_keys(folder: str | Path) -> tuple[Path, Path]:
    """Make the server's pair of CURVE keys; return its files, server.key and server.key_secret. Raises ServerError.

    The secret file has mode 0600.
    """
    root = Path(folder)
    return _make_key_pair("server", root / "server.key", root / "server.key_secret")


def make_client_keys(folder: str | Path, name: str) -> tuple[Path, Path]:
    """Make a client's pair of CURVE keys; return the files of the public and the secret key.

    The public key goes to the allow-list, clients/NAME.key. NAME.key_secret is for the client alone, and has mode 0600.
    Raises ArgumentError, ServerError.
    """
    if not name or len(name) > 64 or not all(c.isalnum() or c in "-_" for c in name):
        raise ArgumentError("name", f"must be letters, digits, - and _, not {name!r}")
    if name == "server":
        raise ArgumentError(
            "name", 'cannot be "server", which is the name of the server\'s own keys'
        )
    root = Path(folder)
    return _make_key_pair(name, root / "clients" / f"{name}.key", root / f"{name}.key_secret")


def _make_key_pair(name: str, public: Path, secret: Path) -> tuple[Path, Path]:
    for file in (public, secret):
        if file.exists():
            raise ServerError(f"{file} already exists: remove it first, or choose another name")
    try:
        public.parent.mkdir(parents=True, exist_ok=True, mode=0o700)
        # The library writes world-readable secret keys, so it writes to a private folder first.
        with tempfile.TemporaryDirectory(dir=secret.parent) as private:
            made = [Path(file) for file in create_certificates(private, name)]
            made[1].chmod(0o600)
            for source, target in zip(made, (public, secret), strict=True):
                source.replace(target)
    except OSError as error:
        raise ServerError(f"{error.filename or secret.parent}: {error.strerror}") from error
    return public, secret


def write_remote_connection(
    folder: str | Path, name: str, host: str, ports: tuple[int, int, int]
) -> Path:
    """Write a connection file, NAME.json, for a client on another machine; return its path. Raises ServerError.

    ports: control, command, state.
    """
    root = Path(folder)
    server, _ = _read_pair(root / "server.key_secret")
    public, secret = _read_pair(root / f"{name}.key_secret")
    control, command, state = (f"tcp://{host}:{port}" for port in ports)
    connection = Connection(
        pid=0,
        control=control,
        command=command,
        state=state,
        server_key=server,
        public_key=public,
        secret_key=secret,
    )
    return connection.write(root / f"{name}.json")


def _read_pair(file: Path) -> tuple[str, str]:
    """Return the public and the secret key of a file."""
    try:
        if os.name == "posix" and file.stat().st_mode & 0o077:
            raise ServerError(f"{file}: others can read or change it: run `chmod 600 {file}`")
        public, secret = load_certificate(file)
    except (OSError, ValueError) as error:
        raise ServerError(
            f"{file}: no such key. `pacinian keys server --folder {file.parent}` makes the server's"
        ) from error
    if not secret:
        raise ServerError(f"{file}: has no secret key")
    return public.decode(), secret.decode()


def _stamp(file: Path) -> tuple[int, int]:
    """Return what changes if a file's content or its permissions do; 0 and 0 if it is not there."""
    try:
        found = file.stat()
    except OSError:
        return 0, 0
    return found.st_mtime_ns, found.st_ctime_ns


def _read_public(file: Path) -> bytes:
    """Return a client's public key; empty if the file has none, or cannot be read."""
    try:
        return load_certificate(file)[0]
    except (OSError, ValueError):
        return b""
