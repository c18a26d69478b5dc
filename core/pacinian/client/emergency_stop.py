"""An emergency stop that needs no session, from any thread or program. It loads little, because it is urgent."""

from __future__ import annotations

import contextlib
import time
from typing import TYPE_CHECKING

from pacinian.client.connection_keys import resolve_connection
from pacinian.client.timeouts import REPLY_TIMEOUT
from pacinian.errors import ConnectionLost, Refused
from pacinian.wire.stop_datagram import request_stop

if TYPE_CHECKING:
    from pathlib import Path

    from pacinian.wire.connection_file import Connection


def emergency_stop(
    connection: Connection | Path | str | None = None,
    *,
    timeout: float = REPLY_TIMEOUT,
    keys: Path | str | None = None,
) -> None:
    """Silence the array at once, whoever owns the output, until `Client.reset`.

    Returns when the server has confirmed it. On the server's machine this needs no connection, so no number of other
    clients can block it. A connection file that others can read is not refused: a stop is never wrong.

    connection, keys: as for `Client`. timeout: for the confirmation [s]. Raises ConnectionLost after the timeout;
    Refused.
    """
    given, begin = resolve_connection(connection, keys, require_private=False), time.perf_counter()
    # half of the time is left for the other way
    if given.stop and request_stop(given.stop, given.secret, timeout / 2.0):
        return
    _stop_by_connection(given, timeout, timeout - (time.perf_counter() - begin))


def _stop_by_connection(given: Connection, timeout: float, left: float) -> None:
    """Stop within `left` seconds of `timeout`; the imports do not count, which take long on a busy machine."""
    import zmq

    from pacinian.client.link import Link, milliseconds
    from pacinian.wire.codec import encode
    from pacinian.wire.control import Stop
    from pacinian.wire.replies import Error, Ok

    deadline = time.perf_counter() + left
    with zmq.Context() as context, contextlib.closing(Link(context, given, given.control)) as link:
        poller = zmq.Poller()
        poller.register(link.socket, zmq.POLLIN)
        poller.register(link.monitor, zmq.POLLIN)
        sent = link.send(encode(Stop(id=1)), max(0.0, deadline - time.perf_counter()))
        while sent and (left := deadline - time.perf_counter()) > 0.0:
            ready = dict(poller.poll(milliseconds(left)))
            for reply in link.receive() if link.socket in ready else ():
                if isinstance(reply, Ok) and reply.id == 1:
                    return
                if isinstance(reply, Error):
                    raise Refused(reply.code, reply.message, reply.path, reply.advice)
            if link.monitor in ready:
                raise link.read_loss()
    raise ConnectionLost(
        f"the server at {given.control} has not confirmed the stop in {timeout:g} s"
    )
