"""The server's TCP ports: whether one is free, and the bind of a ZeroMQ socket to one."""

from __future__ import annotations

import os
import socket
from typing import TYPE_CHECKING

import zmq

from pacinian.errors import ServerError

if TYPE_CHECKING:
    from typing import Any


def find_free_port(host: str, port: int) -> int:
    """Return a free port for a later bind: the given one, or any if it is 0. Raises ServerError."""
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    try:
        with socket.socket(family) as probe:
            # ZeroMQ binds with this option too: lingering connections do not block the port.
            if os.name == "posix":
                probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            probe.bind((host, port))
            return int(probe.getsockname()[1])
    except OSError as error:
        raise _make_error(f"{host}:{port}", error) from error


def bind_socket(unbound: zmq.Socket[Any], endpoint: str) -> int:
    """Bind a socket to a TCP endpoint; return its port. Raises ServerError."""
    try:
        unbound.bind(endpoint)
    except zmq.ZMQError as error:
        raise _make_error(endpoint, error) from error
    return int(str(unbound.get_string(zmq.LAST_ENDPOINT)).rpartition(":")[2])


def _make_error(address: str, error: OSError | zmq.ZMQError) -> ServerError:
    return ServerError(
        f"{address} cannot be bound: {error.strerror}. Is another server running? "
        "Choose another port, or 0 for any"
    )
