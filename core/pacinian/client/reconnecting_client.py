"""The connection of a `Client`: a session that can be lost and replaced by a new one."""

from __future__ import annotations

import itertools
import os
import threading
import time
import warnings
from contextlib import suppress
from typing import TYPE_CHECKING, Any, NoReturn

from pacinian.argument_checks import check_number
from pacinian.client.connection_keys import resolve_connection
from pacinian.client.server_session import ServerSession
from pacinian.client.timeouts import REPLY_TIMEOUT
from pacinian.closeable import Closeable
from pacinian.errors import ConnectionLost, ServerError

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from pacinian.client.server_clock import RoundTrips
    from pacinian.errors import Refused
    from pacinian.wire.connection_file import Connection


class ReconnectingClient(Closeable):
    """Base of `Client`, with the same arguments. A context manager. Belongs to the thread that makes it."""

    def __init__(
        self,
        connection: Connection | Path | str | None = None,
        *,
        name: str = "python",
        scene: str = "",
        lease: float | None = None,
        timeout: float = REPLY_TIMEOUT,
        keys: Path | str | None = None,
        reconnect: bool = False,
        clock: Callable[[], float] = time.perf_counter,
    ) -> None:
        self._timeout = check_number("timeout", timeout, low=0.0, above=True)
        self._where, self._keys, self._clock = connection, keys, clock
        self._reconnects = reconnect
        self._hello: dict[str, Any] = {"client": name, "scene": scene, "lease": lease}
        self._owner = os.getpid(), threading.get_ident()
        self._ids, self._closed = itertools.count(), False
        self._server_session = self._connect()

    @property
    def round_trips(self) -> RoundTrips:
        """Round trips of the last blocking calls."""
        return self._server_session.server_clock.round_trips

    @property
    def errors(self) -> list[Refused]:
        """Errors of the calls that did not wait. Reading this clears them."""
        self._handle_messages()
        errors = list(self._server_session.errors)
        self._server_session.errors.clear()
        return errors

    @property
    def connected(self) -> bool:
        """Whether the session is still connected."""
        self._handle_messages()
        return not self._server_session.lost

    @property
    def armed(self) -> bool:
        """Whether this client's scene is armed, as the server last reported."""
        return self._server_session.armed and self._server_session.owner

    @property
    def lease(self) -> float:
        """Time from the last renewal to silence [s], as agreed with the server."""
        return self._server_session.welcome.lease

    @property
    def scene(self) -> str:
        """The name of the scene."""
        return self._server_session.welcome.scene

    @property
    def server(self) -> str:
        """The name and version of the server."""
        return self._server_session.welcome.server

    def reconnect(self) -> None:
        """Start a new session, after a loss or instead of this one. Reads the connection file again.

        Nothing resumes: put the objects again, and arm again. Raises ConnectionLost, Refused.
        """
        self._check()
        self._server_session.close()
        self._server_session = self._connect()

    def close(self) -> None:
        """End the session. The server removes this client's objects, and silences the output if the client owns it."""
        self._check(closed=True)
        self._closed = True
        self._server_session.close()

    def __del__(self) -> None:
        """Close, so that a notebook cell that is run again finds the output free."""
        if not self.__dict__.get("_closed", True) and "_server_session" in self.__dict__:
            with suppress(Exception):  # fails in another thread or process
                self.close()
            warnings.warn(f"unclosed {self!r}", ResourceWarning, stacklevel=2)

    def __repr__(self) -> str:
        if "_server_session" not in self.__dict__:
            return "<Client, never connected>"
        lost = self._server_session.lost
        what = f"not connected: {lost}" if lost else "armed" if self.armed else "not armed"
        return f"<Client {self._hello['client']!r} of {self.server}, scene {self.scene!r}, {what}>"

    def __reduce__(self) -> NoReturn:
        raise TypeError("a Client cannot be pickled: make one in each process")

    def _connect(self) -> ServerSession:
        given = resolve_connection(self._where, self._keys)
        return ServerSession(given, self._clock, self._timeout, self._ids, **self._hello)

    def _check(self, closed: bool = False) -> None:
        if (os.getpid(), threading.get_ident()) != self._owner:
            raise ServerError(
                "a Client belongs to the thread that made it: make one in each thread"
            )
        if self._closed and not closed:
            raise ConnectionLost("this Client was closed")

    def _handle_messages(self) -> None:
        with suppress(ConnectionLost):
            self._get_session(reconnect=False).handle_messages()

    def _get_session(self, *, reconnect: bool = True) -> ServerSession:
        """Return the session. If it is lost, return a new one, if `reconnect` and the client's own setting allow it."""
        self._check()
        if self._server_session.lost and reconnect and self._reconnects:
            self.reconnect()
        return self._server_session
