"""Who may connect: the mechanism of all the server's sockets, and its keys.

On loopback PLAIN, with a token that is new with each start; elsewhere CURVE, with an allow-list. Both go through
ZAP, so that no byte of a program that may not connect, be it a browser or a port scanner, is ever decoded.
"""

from __future__ import annotations

import logging
import os
import secrets
import tempfile
import threading
from pathlib import Path
from typing import TYPE_CHECKING, Any

import zmq
from zmq.auth import create_certificates, load_certificate
from zmq.auth.thread import ThreadAuthenticator

from pacinian.errors import ArgumentError, ServerError
from pacinian.wire.connection import Connection

if TYPE_CHECKING:
    from types import TracebackType

    from pacinian.serving.settings import Settings

DOMAIN = "pacinian"
USER = "pacinian"
HANDSHAKE = 2000  # [ms] in which a connection must have shown who it is
# [ms] after which what a connection does not confirm ends it. Not by heartbeats of ours: libzmq 4.3 ends the process
# when one is due of a connection that was closed while its messages waited at the high-water mark (`!_io_error`)
UNCONFIRMED = 500
QUEUE = 256  # messages to or from one client
BACKLOG = 128  # connections that wait to be accepted


def make_secrets(settings: Settings) -> dict[str, str]:
    """The secrets of one run, for all who bind sockets: a token; or the server's keys and those of one local client.

    Raises ServerError.
    """
    if settings.network.loopback and not settings.security.keys:
        return {"token": secrets.token_hex(32)}
    public, secret = _read_pair(Path(settings.security.keys) / "server.key_secret")
    local, local_secret = zmq.curve_keypair()
    return {
        "server_key": public,
        "server_secret": secret,
        "public_key": local.decode(),
        "secret_key": local_secret.decode(),
    }


class Authenticator:
    """Lets nobody in without the secrets; a context manager, entered before any socket is bound.

    given: the secrets from `make_secrets`. keys: the folder of keys. A change of its `clients` counts from the next
    connection on.
    """

    def __init__(self, context: zmq.Context[Any], given: dict[str, str], keys: str = "") -> None:
        self._secrets, self._clients = given, Path(keys) / "clients"
        self._names: dict[bytes, str] = {}
        self._stamp: tuple[tuple[str, int], ...] = ()
        log = logging.getLogger("pacinian.zap")
        log.setLevel(logging.INFO)  # below, it would write the token
        self._zap = ThreadAuthenticator(context, log=log)
        self._lock = threading.Lock()
        self._unknown: list[str] = []

    def __enter__(self) -> Authenticator:
        self._zap.start()
        if token := self._secrets.get("token"):
            self._zap.configure_plain(DOMAIN, {USER: token})
        else:
            self._zap.configure_curve_callback(DOMAIN, self)
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._zap.stop()

    def protect(self, socket: zmq.Socket[Any], longest: int) -> None:
        """Set all that a socket needs before `bind`. longest: message [bytes]."""
        options = {
            zmq.LINGER: 0,
            zmq.MAXMSGSIZE: longest,
            zmq.HANDSHAKE_IVL: HANDSHAKE,
            zmq.RCVHWM: QUEUE,
            zmq.SNDHWM: QUEUE,
            zmq.BACKLOG: BACKLOG,
            zmq.IPV6: 1,
            zmq.TCP_MAXRT: UNCONFIRMED,
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
        """Whether a client of this public key (Z85) may connect; called by the authenticator's thread."""
        del domain
        if key == self._secrets["public_key"].encode():
            return True
        known = key in self._listed()
        if not known:
            with self._lock:
                self._unknown = [*self._unknown[-15:], key.decode()]
        return known

    def name(self, user: str) -> str:
        """What a client is called that `User-Id` says is `user`: of its key file, "local", or `user`."""
        if user == self._secrets.get("public_key"):
            return "local"
        return self._names.get(user.encode(), user)

    def unknown(self) -> list[str]:
        """The public keys that were refused since this was asked last, at most 16."""
        with self._lock:
            seen, self._unknown = self._unknown, []
        return seen

    def _listed(self) -> dict[bytes, str]:
        try:
            files = sorted(self._clients.glob("*.key"))
            stamp = tuple((file.name, file.stat().st_mtime_ns) for file in files)
            if stamp != self._stamp:
                self._names = {_read_public(file): file.stem for file in files}
                self._stamp = stamp
        except (
            OSError
        ):  # a key was removed just now, or the folder cannot be read: nobody is let in
            self._names, self._stamp = {}, ()
        self._names.pop(b"", None)
        return self._names


def receive(socket: zmq.Socket[Any]) -> tuple[bytes, str, bytes] | None:
    """What has come next to a ROUTER: peer, `User-Id`, message; empty where it was no single part. None: nothing.

    Part by part, as it takes a third of the time of `recv_multipart`.
    """
    try:
        peer = socket.recv(zmq.NOBLOCK)
        frame = socket.recv(zmq.NOBLOCK, copy=False)
    except zmq.Again:
        return None
    data, more = frame.bytes, frame.more
    while more:
        data, more = b"", socket.recv(zmq.NOBLOCK, copy=False).more
    try:
        return peer, str(frame.get("User-Id")), data
    except zmq.ZMQError:
        return peer, "", data


def make_key_pair(folder: str | Path, name: str, *, server: bool = False) -> tuple[Path, Path]:
    """Make a pair of CURVE keys; return the files of the public and the secret one, the latter 0600.

    The server's are server.key and server.key_secret; a client's public key goes to the allow-list, clients/NAME.key,
    and NAME.key_secret is for the client alone. Raises ArgumentError, ServerError.
    """
    if not name or len(name) > 64 or not all(c.isalnum() or c in "-_" for c in name):
        raise ArgumentError("name", f"must be letters, digits, - and _, not {name!r}")
    if not server and name == "server":
        raise ArgumentError("name", 'cannot be "server": that is the server\'s own')
    root = Path(folder)
    public = (root if server else root / "clients") / f"{name}.key"
    secret = root / f"{name}.key_secret"
    for file in (public, secret):
        if file.exists():
            raise ServerError(f"{file} is there already: remove it first, or choose another name")
    try:
        public.parent.mkdir(parents=True, exist_ok=True, mode=0o700)
        # the library writes secret keys that anybody may read: so in a folder that nobody may
        with tempfile.TemporaryDirectory(dir=root) as private:
            made = [Path(file) for file in create_certificates(private, name)]
            made[1].chmod(0o600)
            for source, target in zip(made, (public, secret), strict=True):
                source.replace(target)
    except OSError as error:
        raise ServerError(f"{error.filename or root}: {error.strerror}") from error
    return public, secret


def write_remote_connection(
    folder: str | Path, name: str, host: str, ports: tuple[int, int, int]
) -> Path:
    """Write a connection file, NAME.json, for a client on another machine; return where. Raises ServerError.

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
    """Public and secret key."""
    try:
        if os.name == "posix" and file.stat().st_mode & 0o077:
            raise ServerError(f"{file}: others can read or change it: `chmod 600 {file}`")
        public, secret = load_certificate(file)
    except (OSError, ValueError) as error:
        raise ServerError(
            f"{file}: no such key: `pacinian keys server --folder {file.parent}` makes the server's"
        ) from error
    if not secret:
        raise ServerError(f"{file}: has no secret key")
    return public.decode(), secret.decode()


def _read_public(file: Path) -> bytes:
    """A client's public key; empty where the file has none."""
    try:
        return load_certificate(file)[0]
    except ValueError:
        return b""
