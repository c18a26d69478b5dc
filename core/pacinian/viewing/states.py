"""Passes the newest published states and frames of a server to the pages, and polls its scene and properties."""

from __future__ import annotations

from contextlib import suppress
from typing import TYPE_CHECKING, Self

import msgspec
import zmq
from msgspec import Raw

from pacinian.client.link import connect, make_socket
from pacinian.errors import ConnectionLost, Refused
from pacinian.viewing.array_model import ArrayModel
from pacinian.viewing.hub import Drive
from pacinian.viewing.messages import WRONG, ArrayMessage, SilenceMessage
from pacinian.viewing.recent_frames import RecentFrames
from pacinian.viewing.region_error import Regions
from pacinian.viewing.scene_mirror import POSE, SceneMirror
from pacinian.viewing.tick_histogram import make_histogram
from pacinian.wire.codec import decode_state
from pacinian.wire.state import FRAME, STATE, FrameState, State

if TYPE_CHECKING:
    from collections.abc import Callable

    from pacinian.client.client import Client
    from pacinian.viewing.hub import Hub
    from pacinian.wire.connection_file import Connection

MAX_STATE_AGE = 2.0  # time without a state after which the server is lost [s]
MAX_WAITING = 16  # maximum number of messages that wait in the socket
# Interval of histograms, and of polls of an empty scene and of the properties [s].
SLOW_INTERVAL = 0.2
ARRAY = set(ArrayMessage.__struct_fields__) - {"server", "fields"}  # as in the wire's `abilities`


class StateReader:
    """Reads the states in one session. A context manager. post: calls a function in the event loop."""

    def __init__(
        self, client: Client, connection: Connection, hub: Hub, post: Callable[..., None]
    ) -> None:
        self._client, self._connection, self._hub, self._post = client, connection, hub, post
        self._socket: zmq.Socket[bytes] | None = None
        self._scenery, self._known = SceneMirror(), ("", 0)
        self._recent = RecentFrames()
        self._drive: Drive | None = None
        self._emitted: Drive | None = None
        self._regions: Regions | None = None
        self._sent: ArrayMessage | None = None
        self._silence: SilenceMessage | None = None
        self._stale = False
        self._frame_time = 0.0  # time of the newest frame [s]; 0 before the first
        self._came = self._looked = self._counted = 0.0
        self._shows = True

    def __enter__(self) -> Self:
        self._array(0.0)
        self._context: zmq.Context[zmq.Socket[bytes]] = zmq.Context()
        return self

    def __exit__(self, *_: object) -> None:
        self._unsubscribe()
        self._context.term()

    def look(self, now: float, *, watched: bool) -> None:
        """Pass on what is new at `now` [s]; request nothing while no page is open. Raises ServerError."""
        if not watched:
            if self._socket is not None:
                self._unsubscribe()
                self._recent.clear()
                self._drive = self._silence = None
                self._post(self._hub.set_idle)
            return
        if self._socket is None:
            self._subscribe()
            self._came = now
        news, frames = self._newest()
        if STATE in news:
            self._came = now
            with suppress(*WRONG):  # skip a damaged one
                self._state(news[STATE], now)
        elif now - self._came > MAX_STATE_AGE:
            raise ConnectionLost(f"the server has published no state within {MAX_STATE_AGE:g} s")
        for data in frames:
            with suppress(*WRONG):
                self._frame(data)
        if frames:
            self._post(self._hub.put, "frame", frames[-1])
        self._emit()
        if self._changed and now >= self._asked + SLOW_INTERVAL:
            self._array(now)
        if self._shows and (self._scenery.poses or now >= self._looked + SLOW_INTERVAL):
            self._looked = now
            self._show()

    def _subscribe(self) -> None:
        self._socket = make_socket(self._context, zmq.SUB, self._connection)
        self._socket.rcvhwm = MAX_WAITING
        connect(self._socket, self._connection.state)
        self._socket.subscribe(STATE)
        self._socket.subscribe(FRAME)

    def _unsubscribe(self) -> None:
        if self._socket is not None:
            self._socket.close(0)
            self._socket = None

    def _newest(self) -> tuple[dict[bytes, bytes], list[bytes]]:
        """Return the newest message of each topic, and all frames."""
        news: dict[bytes, bytes] = {}
        frames: list[bytes] = []
        while self._socket is not None:
            try:
                topic, data = self._socket.recv_multipart(zmq.NOBLOCK)
            except zmq.Again:
                break
            news[topic] = data
            if topic == FRAME:
                frames.append(data)
        return news, frames

    def _array(self, now: float) -> None:
        backend = self._client.status().backend  # first, so that the reply is not older
        capabilities = self._client.capabilities()
        self._capabilities, self._model = capabilities, ArrayModel.of(capabilities)
        self._asked, self._backend = now, backend
        # The server may still be listing them.
        self._changed = not (capabilities.solvers and capabilities.backends)
        fields = {name: getattr(capabilities, name) for name in ARRAY}
        server = self._client.server
        array = ArrayMessage(server=server, fields=self._model is not None, **fields)
        self._recent.clear()
        self._drive = None
        if array != self._sent:
            self._sent = array
            self._post(self._hub.put, "array", array)

    def _state(self, data: bytes, now: float) -> None:
        state = decode_state(data)
        if not isinstance(state, State):
            return
        self._post(self._hub.put, "state", data)
        self._changed |= state.backend != self._backend
        if state.tick_counts and now >= self._counted + SLOW_INTERVAL:
            self._counted = now
            self._post(
                self._hub.put,
                "histogram",
                make_histogram(state.tick_counts, self._capabilities.rate),
            )
        self._recent.see_state(state.time, state.technique, state.hands, state.presentation)
        self._explain(state)
        self._stale = state.output == "stale"
        if state.output in ("stopped", "faulted"):
            self._recent.clear()
        self._regions = Regions.of(state, self._recent.find_strengths(state.objects))

    def _explain(self, state: State) -> None:
        """Pass on why the output is silent, if that has changed."""
        message = SilenceMessage(cause=state.cause, text=state.why)
        if message != self._silence:
            self._silence = message
            self._post(self._hub.put, "silence", message)

    def _frame(self, data: bytes) -> None:
        frame, abilities = decode_state(data), self._capabilities
        if not isinstance(frame, FrameState):
            return
        self._changed |= (frame.phases, frame.amplitudes) != (
            abilities.phases,
            abilities.amplitudes,
        )
        self._frame_time = frame.time
        if self._model is not None and (frame.phase or not self._stale):  # a gap is not modulation
            self._recent.add(
                frame.time, self._model.gains(frame), frame.scene_time, frame.part, frame.parts
            )

    def _emit(self) -> None:
        """Pass on the input of the field computation, if it has changed."""
        if self._model is not None and self._frame_time:
            (gains, shares), last = self._recent.gains(), self._drive
            new = Drive(self._model, gains, self._frame_time, self._regions, shares)
            if last is not None and last._replace(time=new.time, regions=new.regions) == new:
                new = new._replace(time=last.time)
            self._drive = new
        if self._drive != self._emitted and self._drive is not None:
            self._post(self._hub.set_drive, self._drive)
        self._emitted = self._drive

    def _show(self) -> None:
        """Request what is new in the scene."""
        try:
            reply = self._client.show(*self._known)
        except Refused as error:
            self._shows = error.code != "malformed"  # a server of protocol 1.0 has no `show`
            return
        before = self._scenery
        if reply.scene != self._known[0]:  # names may denote other objects there
            self._scenery = before.with_(reply.scene, {}, {})
        self._known = reply.scene, reply.version
        objects = {name: Raw(msgspec.msgpack.encode(item)) for name, item in reply.objects.items()}
        poses = {
            name: reply.poses[POSE * i : POSE * i + POSE] for i, name in enumerate(reply.names)
        }
        self._scenery = self._scenery.with_(reply.scene, objects, poses)
        self._recent.see_scene(self._frame_time, reply.objects, self._scenery.poses)
        if self._scenery is not before:
            self._post(self._hub.show, self._scenery)
