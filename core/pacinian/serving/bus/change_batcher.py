"""The change batcher: sends the newest changes of the owner's scene to the renderer."""

from __future__ import annotations

from itertools import islice
from typing import TYPE_CHECKING

from pacinian.serving.bus.pending_changes import MOVED, WRAPPED
from pacinian.serving.bus.stored_object import AT_ONCE
from pacinian.serving.ipc.messages import Changes, PutObject, RemoveObject, ResetScene, SetEnvelope

if TYPE_CHECKING:
    from pacinian.serving.bus.admission import Client
    from pacinian.serving.bus.shared_scene import SharedScene
    from pacinian.serving.bus.stored_object import StoredObject
    from pacinian.serving.ipc.messages import AnyChange, ChangesAck
    from pacinian.wire.replies import Error

MAX_BATCH_OBJECTS = 64  # maximum number of objects in one batch
# Maximum number of moves, removals and new envelopes in a batch while objects wait to be put.
LIGHT = 48
BYTES = 1 << 20  # maximum size of one batch, unless a single object is larger [bytes]


class ChangeBatcher:
    """Makes batches of changes for the renderer, each only when the last was taken.

    Objects are sent in the order in which they were put, except for those that take long to convert.

    run: random, identifies this run of the bus. scene: the rendered scene. errors: clients, and the errors of their
    objects that proved invalid.
    """

    def __init__(self, run: int) -> None:
        self.run = run
        self.scene: SharedScene | None = None
        self.errors: list[tuple[Client, Error]] = []
        self._number = 0
        self._renderer: int | None = None
        self._waits = False

    def feel(self, room: SharedScene) -> None:
        """Render this scene from now on."""
        if room is not self.scene:
            self.scene = room
            self._begin()

    def acknowledge(self, taken: ChangesAck) -> None:
        """Note the last batch that the renderer took. A new renderer needs the whole scene."""
        known, self._renderer = self._renderer, taken.run
        mine = taken.bus == self.run and taken.number == self._number
        if taken.run != known and not (known is None and mine):
            self._begin()
            self._waits = False
        elif mine:
            self._waits = False

    def resend_scene(self) -> None:
        """Send the whole scene again, because the last batch could not be published."""
        self._waits = False
        self._begin()

    @property
    def waits(self) -> bool:
        """Whether there is more to send once the last batch is taken."""
        return self.scene is not None and len(self.scene.pending) > 0

    def next(self) -> Changes | None:
        """Return the next batch, which the caller must publish; None if the last was not taken or nothing is new."""
        room = self.scene
        if self._waits or room is None or not len(room.pending):
            return None
        batch = Batch()
        _first(room, batch)
        _is_light(room, batch)
        self._puts(room, batch)
        if not batch.changes:
            return None
        self._number += 1
        self._waits = True
        return Changes(self._number, self.run, tuple(batch.changes))

    def _begin(self) -> None:
        if self.scene is not None:
            self.scene.pending.all(list(self.scene.objects))

    def _puts(self, room: SharedScene, batch: Batch) -> None:
        news, fresh = room.pending, 0
        for name in list(news.puts):
            thing = room.objects[name]
            if batch.objects >= MAX_BATCH_OBJECTS:
                return
            if thing.heavy:
                continue  # it is still being converted
            if thing.item is not None:
                fresh += 1
                if fresh > AT_ONCE:
                    return
                if not self._pack(room, thing):
                    continue
            if not batch.fits(len(thing.packed)):
                return
            if news.puts.pop(name):
                batch.changes.append(RemoveObject(name))
            batch.changes.append(PutObject(name, thing.packed, thing.default))
            news.known.add(name)
            if (move := thing.move()) is not None:
                batch.changes.append(move)
            if thing.wrapped and batch.fits(len(thing.wrapped)):
                batch.changes.append(SetEnvelope(name, thing.wrapped))
            elif thing.wrapped:
                news.new(name, WRAPPED)
            batch.objects += 1

    def _pack(self, room: SharedScene, thing: StoredObject) -> bool:
        error = room.pack(thing)
        if error is not None:
            self.errors.append((thing.owner, error))
        return error is None


class Batch:
    """Changes gathered for one batch. objects: number of changed objects; hands and zones do not count."""

    def __init__(self) -> None:
        self.changes: list[AnyChange] = []
        self.objects = 0
        self._size = 0

    def fits(self, size: int) -> bool:
        """Add `size` bytes if they fit; return whether they do. The first always fit."""
        if self._size and self._size + size > BYTES:
            return False
        self._size += size
        return True


def _first(room: SharedScene, batch: Batch) -> None:
    news = room.pending
    if news.begin:
        batch.changes.append(ResetScene(room.number))
    if news.quiet:
        batch.changes.append(room.all_quiet())
    if news.hands:
        batch.changes.append(room.all_hands())
    news.begin = news.quiet = news.hands = False


def _is_light(room: SharedScene, batch: Batch) -> None:
    news = room.pending
    for name in list(islice(news.light, LIGHT if news.puts else MAX_BATCH_OBJECTS)):
        what, thing = news.light[name], room.objects.get(name)
        if thing is None:
            news.known.discard(name)
            batch.changes.append(RemoveObject(name))
        else:
            if what & WRAPPED:
                if not batch.fits(len(thing.wrapped)):
                    return
                batch.changes.append(SetEnvelope(name, thing.wrapped))
            if what & MOVED and (move := thing.move()) is not None:
                batch.changes.append(move)
        del news.light[name]
        batch.objects += 1
