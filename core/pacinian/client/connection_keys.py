"""Connection data: a connection file, and CURVE keys in files of their own."""

from __future__ import annotations

import os
from pathlib import Path

from msgspec.structs import replace

from pacinian.errors import ArgumentError, ConnectionLost, ServerError
from pacinian.wire.connection_file import Connection

SERVER = "server.key"
MAKE_KEYS = "`pacinian keys` makes one"


def resolve_connection(
    connection: Connection | Path | str | None,
    keys: Path | str | None,
    *,
    require_private: bool = True,
) -> Connection:
    """Return the given connection, or read it from a file; add the keys from a file or a folder.

    keys: NAME.key_secret, or a folder that holds one. The server's public key is in the connection, or beside that
    file. require_private: whether to refuse a connection file that others can read or change. Raises ConnectionLost,
    ArgumentError.
    """
    if isinstance(connection, Connection):
        made = connection
    else:
        try:
            made = Connection.read(connection or "", require_private=require_private)
        except ServerError as error:
            raise ConnectionLost(str(error)) from None
    return made if keys is None else _with_keys(made, Path(keys))


def _with_keys(connection: Connection, path: Path) -> Connection:
    secret = path
    if path.is_dir():
        ours = [file for file in path.glob("*.key_secret") if file.stem != "server"]
        if len(ours) != 1:
            raise ArgumentError("keys", f"must be one file: {path} has {len(ours)} *.key_secret")
        secret = ours[0]
    public, private = _read(secret)
    server = secret.with_name(SERVER)
    theirs = _read(server)[0] if server.exists() else connection.server_key
    if not theirs or not private:
        lacks = f"{secret} has no secret key" if theirs else f"{server} does not exist"
        raise ArgumentError(
            "keys", f"must have the client's secret and the server's public key: {lacks}"
        )
    # The connectionless stop needs the secret of the connection file, so it is not used here.
    return replace(connection, server_key=theirs, public_key=public, secret_key=private, stop="")


def _read(path: Path) -> tuple[str, str]:
    from zmq.auth import load_certificate

    try:
        public, secret = load_certificate(path)
    except (OSError, ValueError) as error:
        raise ArgumentError("keys", f"{path} is not a key file: {error}; {MAKE_KEYS}") from error
    if secret and os.name == "posix" and path.stat().st_mode & 0o077:
        raise ArgumentError("keys", f"{path}: others can read or change it: run `chmod 600 {path}`")
    return public.decode(), (secret or b"").decode()
