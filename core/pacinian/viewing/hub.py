"""The newest values, for all pages. A slow page skips values, so none are queued. Belongs to the event loop."""

from __future__ import annotations

import itertools
from collections import deque
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from msgspec.structs import replace

from pacinian.viewing.messages import (
    Disarm,
    Lost,
    Refused,
    SessionMessage,
    Slice,
    Volume,
    encode_message,
)
from pacinian.viewing.scene_mirror import SceneMirror

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from pacinian.viewing.array_model import ArrayModel
    from pacinian.viewing.messages import AnyPageMessage, FieldRequest, ServerMessage
    from pacinian.viewing.region_error import Regions

BASIS = "hello", "array", "lost"  # values that all others depend on, so they are sent first
ORDER = "record", "replay", "history", "histogram", "silence", "frame", "state"
NOW = "histogram", "silence", "frame", "state"  # values that expire soon
GONE = "array", *NOW  # values removed when the server is lost
MAX_WAITING_REFUSALS = 64  # maximum number of refusals that wait for one page


class Drive(NamedTuple):
    """The input of the field computation. gains: gains of the frames that are averaged, (K, N) complex64.

    The newest frame comes last; `gains` is empty in silence. time: time of the newest frame [s]. regions: None if no
    regions are known. shares: share of the time of each frame, (K,); empty if all shares are equal.
    """

    model: ArrayModel
    gains: bytes
    time: float
    regions: Regions | None = None
    shares: tuple[float, ...] = ()

    def frames(self, asked: Slice) -> int:
        """Return the number of frames that count for the request."""
        one = 8 * len(self.model.array)
        return 1 if asked.over == "instant" else max(len(self.gains) // one, 1)

    def choose_frames(self, asked: FieldRequest) -> Drive:
        """Return the drive with the frames that count for the request, scaled so that all have equal shares.

        A skin and an error always use the mean. The peak needs no shares.
        """
        over = "mean"
        if isinstance(asked, Volume) or (isinstance(asked, Slice) and asked.of == "pressure"):
            over = asked.over
        if over == "instant":
            newest = self.gains[-8 * len(self.model.array) :]
            return self._replace(gains=newest if newest.strip(b"\0") else b"", shares=())
        if over == "peak" or len(self.shares) < 2:
            return self._replace(shares=())
        frames = np.frombuffer(self.gains, np.complex64).reshape(len(self.shares), -1)
        factors = np.sqrt(len(self.shares) * np.array(self.shares, np.float32))
        return self._replace(gains=(factors[:, None] * frames).tobytes(), shares=())


class Hub:
    """The newest values, and the views that receive them.

    drive: None if the field cannot be computed. ask: passes the request of a page (its number first) to the source,
    which is a server or a recording. record: starts or ends a recording for a page.
    """

    def __init__(self) -> None:
        self.drive: Drive | None = None
        self.ask: Callable[[int, AnyPageMessage], None] = lambda page, asked: None
        self.record: Callable[[int, bool], None] = lambda page, on: None
        self.values: dict[str, tuple[int, bytes]] = {}
        self.scenery = SceneMirror()
        self.session: tuple[SessionMessage, int] | None = None
        self.views: dict[int, View] = {}
        self._numbers = itertools.count(1)

    def put(self, kind: str, message: ServerMessage | bytes) -> None:
        """Replace the value of that kind."""
        if kind == "array":
            self.values.pop("lost", None)
        data = message if isinstance(message, bytes) else encode_message(message)
        self.values[kind] = next(self._numbers), data
        self.wake_views()

    def wake_views(self) -> None:
        """Wake all views."""
        for view in list(self.views.values()):
            view.wake()

    def set_drive(self, drive: Drive | None) -> None:
        """Set the drive, after the emission changed."""
        self.drive = drive
        self.wake_views()

    def show(self, scenery: SceneMirror) -> None:
        """Set the scene, after it changed."""
        self.scenery = scenery
        self.wake_views()

    def set_session(self, session: SessionMessage, owner: int) -> None:
        """Set the state of the viewer's session with the server. owner: the page that armed."""
        self.session = session, owner
        self._let_go()
        self.wake_views()

    def set_idle(self) -> None:
        """Clear values that expire, because no page is open."""
        for kind in NOW:
            self.values.pop(kind, None)
        self.drive = None

    def disconnect(self, reason: str) -> None:
        """Clear the values of the server, and report why it is gone."""
        for kind in GONE:
            self.values.pop(kind, None)
        self.drive = self.session = None
        self.scenery = SceneMirror()
        self.put("lost", Lost(reason=reason))

    def refuse(self, page: int, action: str, message: str, advice: str = "") -> None:
        """Report a refused request to one page, or to all pages if `page` is 0."""
        data = encode_message(Refused(action=action, message=message, advice=advice))
        for number, view in list(self.views.items()):
            if page in (0, number):
                view.events.append(data)
                view.wake()

    def join(self, wake: Callable[[], object]) -> View:
        """Return a new view; `wake` is called when there is something new for it."""
        view = View(self, next(self._numbers), wake)
        self.views[view.number] = view
        return view

    def leave(self, view: View) -> None:
        """Remove a view."""
        self.views.pop(view.number, None)
        self._let_go()

    def _let_go(self) -> None:
        """Disarm if the page that armed has gone."""
        if self.session is None:
            return
        session, owner = self.session
        if session.armed and owner not in self.views:
            self.ask(owner, Disarm())


class View:
    """What one page or recorder has received. number: its unique number. events: refusals that wait for it."""

    def __init__(self, hub: Hub, number: int, wake: Callable[[], object]) -> None:
        self.number, self.wake = number, wake
        self.events = deque[bytes](maxlen=MAX_WAITING_REFUSALS)
        self._hub = hub
        self._seen: dict[str, int] = {}
        self._scenery = SceneMirror()
        self._session: tuple[SessionMessage, int] | None = None

    def take(self) -> Iterator[tuple[str, bytes]]:
        """Yield the newest value of each kind that is new for this view, read at the moment it is sent."""
        hub = self._hub
        for kind in ORDER:
            yield from self._basis()
            yield from self._new(kind)
        yield from self._basis()
        if (now := hub.scenery) is not self._scenery:
            since, self._scenery = self._scenery.version, now
            yield now.encode(since)
        if hub.session is not self._session and hub.session is not None:
            self._session = hub.session
            session, owner = hub.session
            mine = session.armed and owner == self.number
            yield "session", encode_message(replace(session, mine=mine))
        while self.events:
            yield "refused", self.events.popleft()

    def _basis(self) -> Iterator[tuple[str, bytes]]:
        """Yield new basis values until there are none; more may arrive while one is sent."""
        while found := next((new for kind in BASIS for new in self._new(kind)), None):
            yield found

    def _new(self, kind: str) -> Iterator[tuple[str, bytes]]:
        number, data = self._hub.values.get(kind, (0, b""))
        if number > self._seen.get(kind, 0):
            self._seen[kind] = number
            yield kind, data
