"""A client of the running server, in a thread: it passes the newest values to the pages, and their requests to it.

It reconnects by itself when the server comes back, and loads the server no more than any other client.
"""

from __future__ import annotations

import logging
import math
import queue
import threading
import time
from contextlib import suppress
from functools import partial
from typing import TYPE_CHECKING

from pacinian.client.client import Client
from pacinian.client.connection_keys import resolve_connection
from pacinian.client.emergency_stop import emergency_stop
from pacinian.errors import ConnectionLost, PacinianError, Refused, describe_error
from pacinian.viewing.demonstration import Demonstration
from pacinian.viewing.messages import (
    Alive,
    Arm,
    Demonstrate,
    Disarm,
    Reset,
    Select,
    SessionMessage,
    Stop,
)
from pacinian.viewing.states import StateReader
from pacinian.wire.convert_modulation import technique_to_scene

if TYPE_CHECKING:
    from asyncio import AbstractEventLoop
    from collections.abc import Callable
    from pathlib import Path

    from pacinian.viewing.hub import Hub
    from pacinian.viewing.messages import AnyPageMessage
    from pacinian.wire.connection_file import Connection

log = logging.getLogger(__name__)
NAME = "viewer"
POLL_INTERVAL, IDLE_INTERVAL = 1.0 / 30.0, 0.1  # polling intervals with and without open pages [s]
RETRY_INTERVAL = 0.5  # interval between attempts to connect [s]
UNARMED_RENEWAL = 1.0  # interval between renewals while the viewer is not armed [s]
MAX_ALIVE_AGE = 0.5  # maximum age of an `alive` that counts, as a share of the lease
MAX_WAITING = 64  # maximum number of waiting requests, and of selections without a reply


class ServerConnection:
    """Runs from `start` to `close`. where: the connection file, as for `pacinian.Client`."""

    def __init__(self, hub: Hub, loop: AbstractEventLoop, where: Path | str | None) -> None:
        self._hub, self._loop, self._where = hub, loop, where
        self._inbox: queue.Queue[tuple[int, AnyPageMessage]] = queue.Queue(MAX_WAITING)
        self._ended, self._stopping = threading.Event(), threading.Lock()
        self._waiting = (
            threading.Lock()
        )  # held by a stop that waits until the one before it has ended
        self._scene = ""
        self._owner, self._alive = 0, -math.inf  # the page that armed, and its last `alive` [s]
        self._armed, self._renewed = False, -math.inf
        self._selected: dict[int, int] = {}  # pages by the id of their selection
        self._lost = ""  # last reported reason
        self._first: tuple[int, AnyPageMessage] | None = None
        self._demonstration: Demonstration | None = None
        self._demonstrated = 0  # the page that requested it
        self._posted: tuple[SessionMessage, int] | None = None
        self._thread = threading.Thread(target=self._run, name="server connection", daemon=True)

    def start(self) -> None:
        """Start the thread, and accept requests from pages."""
        self._hub.ask = self.ask
        self._thread.start()

    def close(self) -> None:
        """End the thread; the output goes silent if a page had armed it."""
        self._ended.set()
        if self._demonstration is not None:
            self._demonstration.close()
        self._thread.join()

    def ask(self, page: int, asked: AnyPageMessage) -> None:
        """Queue a request of a page; carry out an emergency stop at once, in its own thread."""
        ends = isinstance(asked, Stop) or (isinstance(asked, Arm) and asked.take)
        if ends and self._demonstration is not None:
            self._demonstration.end()  # quietly: the page wants it
        if isinstance(asked, Stop):
            threading.Thread(target=self._stop, args=(page,), name="stop").start()
        elif isinstance(asked, Alive):  # not queued: an old one must not renew the lease
            if page == self._owner:
                self._alive = time.perf_counter()
            if page == self._demonstrated and self._demonstration is not None:
                self._demonstration.keep_alive()
        elif isinstance(asked, Demonstrate):
            if asked.on:
                self._start_demonstration(page)
            else:
                self._end_demonstration()
        elif not isinstance(asked, (Arm, Disarm, Reset, Select)):
            self._hub.refuse(page, _action(asked), "is for recordings: this is a server")
        else:
            try:
                self._inbox.put_nowait((page, asked))
            except queue.Full:
                self._hub.refuse(page, _action(asked), "too much is asked at once")

    def _start_demonstration(self, page: int) -> None:
        """Start the demonstration for that page; keep one that plays alive, whichever page started it."""
        playing = self._demonstration
        if playing is not None and playing.plays:
            playing.keep_alive()
            return
        refuse = partial(self._post, self._hub.refuse, page, "demonstrate")
        is_open = partial(self._hub.views.__contains__, page)
        self._demonstration = Demonstration(self._where, is_open, refuse, playing)
        self._demonstrated = page

    def _end_demonstration(self) -> None:
        """End the demonstration that plays, whichever page started it."""
        if self._demonstration is not None and self._demonstration.plays:
            self._demonstration.end()

    def _stop(self, page: int) -> None:
        if not self._waiting.acquire(blocking=False):
            return  # the stop that waits will do
        try:
            with self._stopping:
                self._waiting.release()
                emergency_stop(self._where)
        except Exception as error:  # any error means that the output was not stopped
            self._post(
                self._hub.refuse, page, "stop", describe_error(error), "switch the array off"
            )

    def _post(self, do: Callable[..., object], *arguments: object) -> None:
        """Call a function in the event loop; do nothing after that has ended."""
        with suppress(RuntimeError):
            self._loop.call_soon_threadsafe(do, *arguments)

    def _run(self) -> None:
        while not self._ended.is_set():
            try:
                connection = resolve_connection(self._where, None)
                with Client(connection, name=NAME, scene=self._scene) as client:
                    self._watch(client, connection)
            except Exception as error:
                self._lose(error)

    def _lose(self, error: Exception) -> None:
        """Report the end of the session, and refuse the waiting requests. Nothing resumes.

        If the server refused another scene, reconnect at once to the viewer's own scene instead.
        """
        first, self._first, self._scene = self._first, None, ""
        if first is not None:
            self._refuse(*first, error)
            if isinstance(error, Refused):
                return
        with suppress(queue.Empty):
            while True:
                self._refuse(*self._inbox.get_nowait(), error)
        if str(error) != self._lost:
            self._lost = str(error)
            if not isinstance(error, PacinianError):
                log.error("the viewer cannot go on with this server", exc_info=error)
            self._post(self._hub.disconnect, self._lost)
        self._ended.wait(RETRY_INTERVAL)

    def _watch(self, client: Client, connection: Connection) -> None:
        """Run one session until it is lost, a page arms another scene, or the viewer ends."""
        self._owner, self._armed, self._posted, scene = 0, False, None, self._scene
        self._selected.clear()
        with StateReader(client, connection, self._hub, self._post) as states:
            self._lost, due = "", time.perf_counter()
            while not self._ended.is_set():
                self._obey(client, due)
                if self._scene != scene:
                    return
                self._keep(client)
                if (now := time.perf_counter()) < due:
                    continue
                watched = bool(self._hub.views)
                due = max(due + (POLL_INTERVAL if watched else IDLE_INTERVAL), now)
                if not client.connected:
                    raise ConnectionLost("the server has gone")
                states.look(now, watched=watched)
                self._tell(client)

    def _obey(self, client: Client, due: float) -> None:
        """Handle one request of a page; wait for it until `due`, when the state is read again [s]."""
        try:
            wait = max(0.0, due - time.perf_counter())
            page, asked = self._first or (
                self._inbox.get(timeout=wait) if wait else self._inbox.get_nowait()
            )
        except queue.Empty:
            return
        self._first = None
        try:
            self._do(client, page, asked)
        except PacinianError as error:
            self._refuse(page, asked, error)
            if isinstance(error, ConnectionLost):
                raise
        self._tell(client)

    def _do(self, client: Client, page: int, asked: AnyPageMessage) -> None:
        match asked:
            case Arm() if asked.scene != self._scene:
                self._scene, self._first = asked.scene, (page, asked)
            case Arm():
                client.arm(
                    asked.take, resume=False
                )  # a page that was in the background must ask again
                self._owner, self._armed = page, True
                self._renew(client)
            case Disarm():
                client.disarm()
            case Reset():
                client.reset()
            case Select():
                technique = None if asked.technique is None else technique_to_scene(asked.technique)
                number = client.select(
                    solver=asked.solver, backend=asked.backend, technique=technique,
                    intensity=asked.intensity, wait=False,
                )  # fmt: skip
                self._selected[number] = page
                if len(self._selected) > MAX_WAITING:
                    del self._selected[min(self._selected)]
            case _:
                pass

    def _keep(self, client: Client) -> None:
        """Renew the lease while the page that armed is visible, or the session while nothing is armed."""
        now, was = time.perf_counter(), self._armed
        self._armed = client.armed
        if self._armed:
            due = self._alive > self._renewed and now - self._alive < MAX_ALIVE_AGE * client.lease
        else:
            # If it has just ended, the reply says why.
            due = was or now - self._renewed > UNARMED_RENEWAL
        if due:
            self._renew(client)
        if was and not self._armed:
            with suppress(Refused):  # another client has the output
                client.disarm()  # no page can renew this: leave the output to others

    def _renew(self, client: Client) -> None:
        self._renewed = time.perf_counter()
        try:
            client.renew()
        except Refused as error:
            self._refuse(self._owner, Arm(), error)

    def _tell(self, client: Client) -> None:
        """Report new refusals and the state of the session to the pages."""
        for error in client.errors:
            self._refuse(self._selected.pop(error.request, 0), Select(), error)
        armed = client.armed
        session = SessionMessage(
            name=NAME, scene=self._scene, lease=client.lease, armed=armed, mine=False
        )
        if (session, self._owner) != self._posted:
            self._posted = session, self._owner
            self._post(self._hub.set_session, *self._posted)

    def _refuse(self, page: int, asked: AnyPageMessage, error: Exception) -> None:
        advice = error.advice if isinstance(error, Refused) else ""
        message = str(error).removesuffix(f"; {advice}")
        self._post(self._hub.refuse, page, _action(asked), message, advice)


def _action(asked: AnyPageMessage) -> str:
    return str(asked.__struct_config__.tag)
