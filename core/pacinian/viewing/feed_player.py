"""Plays a feed file in place of a server: sends its messages at their times, from any time on, at any speed."""

from __future__ import annotations

import asyncio
import math
import time
from bisect import bisect_right
from contextlib import suppress
from typing import TYPE_CHECKING, TypeVar

import msgspec
from msgspec import Raw

from pacinian.viewing.array_model import ArrayModel
from pacinian.viewing.history import collect_history
from pacinian.viewing.hub import Drive
from pacinian.viewing.messages import (
    WRONG,
    ArrayMessage,
    Histogram,
    Lost,
    PlaybackState,
    Replay,
    SceneryMessage,
    encode_message,
)
from pacinian.viewing.recent_frames import MODULATED_SPAN, RecentFrames
from pacinian.viewing.region_error import Regions
from pacinian.viewing.scene_mirror import SceneMirror
from pacinian.wire.codec import decode_state
from pacinian.wire.objects import Object
from pacinian.wire.state import State

if TYPE_CHECKING:
    from pacinian.viewing.feed_file import Entry, FeedFile
    from pacinian.viewing.hub import Hub
    from pacinian.viewing.messages import AnyPageMessage

T = TypeVar("T")
_objects: msgspec.msgpack.Decoder[Object] = msgspec.msgpack.Decoder(Object)

UPDATE_INTERVAL = 1.0 / 30.0  # interval between updates [s]
MIN_JUMP = 1.0  # minimum jump after which the charts are refilled [s]
# Kinds that a newer message of another kind makes obsolete.
AGAINST = {
    "array": ("lost",),
    "lost": ("array", "histogram", "frame", "state"),
    "scenery": ("poses",),
}


class FeedPlayer:
    """Plays to the pages of a hub; starts at once, from the beginning."""

    def __init__(self, hub: Hub, recorded: FeedFile) -> None:
        self.time, self.speed, self.playing = 0.0, 1.0, True
        self._hub, self._recorded = hub, recorded
        self._times = [entry.at for entry in recorded.entries]
        self._place = 0  # index of the first entry that has not been shown
        self._scenery = SceneMirror()
        self._model: ArrayModel | None = None
        self._recent = RecentFrames()
        self._regions: Regions | None = None
        self._time = 0.0  # of the newest state or frame, by the server's clock [s]
        self._past = -math.inf  # time shown last [s]
        self._pages: set[int] = set()  # pages that have the past of the charts
        self._turn = asyncio.Event()
        hub.ask, hub.record = self.ask, lambda page, on: self._not_here(page, "record")

    def ask(self, page: int, asked: AnyPageMessage) -> None:
        """Carry out a page's `replay`; refuse all other requests."""
        if not isinstance(asked, Replay):
            self._not_here(page, str(asked.__struct_config__.tag))
            return
        self.speed = self.speed if asked.speed is None else asked.speed
        if asked.time is not None:
            self.time = min(asked.time, self._recorded.duration)
            self._past = -math.inf
        if asked.playing is not None:
            self.playing = asked.playing
            if self.playing and self.time >= self._recorded.duration:
                self.time = 0.0  # play again
        self._turn.set()

    def _not_here(self, page: int, action: str) -> None:
        self._hub.refuse(page, action, "is for a server: this is a recording")

    async def run(self) -> None:
        """Play until cancelled."""
        while True:
            begin = time.perf_counter()
            self.show()
            if self.playing:
                await asyncio.sleep(UPDATE_INTERVAL)
                self.advance(time.perf_counter() - begin)
            else:
                self._turn.clear()
                await self._turn.wait()

    def advance(self, seconds: float) -> None:
        """Advance the playback by `seconds` at its speed."""
        if self.playing:
            self.time = min(self.time + self.speed * seconds, self._recorded.duration)
            self.playing = self.time < self._recorded.duration

    def show(self) -> None:
        """Send the pages what is new at the current time."""
        place = bisect_right(self._times, self.time)
        if place < self._place:
            self._place, self._scenery = 0, SceneMirror()
            self._recent.clear()
            self._past = -math.inf
        newest: dict[str, Entry] = {}
        for entry in self._recorded.entries[self._place : place]:
            if entry.kind == "scenery" or (
                entry.kind == "frame" and entry.at > self.time - MODULATED_SPAN
            ):
                self._tell(entry)
            for other in AGAINST.get(entry.kind, ()):
                newest.pop(other, None)
            newest[entry.kind] = entry
        self._place = place
        for entry in newest.values():
            self._tell(entry)
        if self._model is not None and newest.keys() & {"frame", "state"}:
            gains, shares = self._recent.gains()
            self._hub.set_drive(Drive(self._model, gains, self._time, self._regions, shares))
        if self._scenery is not self._hub.scenery:
            self._hub.show(self._scenery)
        if self._model is not None:
            pages = set(self._hub.views)
            # A page that joins later, also while nothing plays, receives the past that was sent last.
            if self.time - self._past > MIN_JUMP or pages - self._pages or not self.playing:
                past = collect_history(self._recorded, self._recorded.entries[:place], self._model)
                self._hub.put("history", past)
            self._past, self._pages = self.time, pages
        stands = PlaybackState(
            time=self.time, duration=self._recorded.duration, playing=self.playing, speed=self.speed
        )
        self._hub.put("replay", stands)

    def _tell(self, entry: Entry) -> None:
        """Decode a message, and pass it to the hub in a new encoding. Skip a damaged one."""
        hub = self._hub
        with suppress(*WRONG):
            data = self._recorded.data(entry)
            match entry.kind:
                case "array":
                    array = _decode(data, ArrayMessage)
                    if hub.values.get("array", (0, b""))[1] != encode_message(array):
                        self._model = None
                        self._recent.clear()
                        hub.put("array", array)
                        self._model = ArrayModel.of(array)
                case "lost":
                    self._regions = None
                    self._recent.clear()
                    hub.disconnect(_decode(data, Lost).reason)
                case "scenery" | "poses":
                    scene = _decode(data, SceneryMessage)
                    new = {name: _objects.decode(item) for name, item in scene.objects.items()}
                    objects = {
                        name: Raw(msgspec.msgpack.encode(item)) for name, item in new.items()
                    }
                    self._scenery = self._scenery.with_(scene.scene, objects, scene.poses)
                    self._recent.see_scene(self._time, new, scene.poses)
                case "histogram":
                    hub.put("histogram", _decode(data, Histogram))
                case "frame" | "state":
                    said = decode_state(data)
                    hub.put(entry.kind, msgspec.msgpack.encode(said))
                    self._time = said.time
                    if isinstance(said, State):
                        self._recent.see_state(
                            said.time, said.technique, said.hands, said.presentation
                        )
                        strengths = self._recent.find_strengths(said.objects)
                        self._regions = Regions.of(said, strengths)
                    elif self._model is not None:
                        self._recent.add(
                            said.time,
                            self._model.gains(said),
                            said.scene_time,
                            said.part,
                            said.parts,
                        )
                case _:
                    pass  # a kind of a later version


def _decode(data: bytes, kind: type[T]) -> T:
    return msgspec.msgpack.decode(data, type=kind)
