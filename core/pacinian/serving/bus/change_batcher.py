"""The change batcher: sends the newest changes of the owner's scene to the renderer."""

from __future__ import annotations

from itertools import islice
from typing import TYPE_CHECKING

from pacinian.serving.bus.pending_changes import MOVED, NEW_ENVELOPE
from pacinian.serving.bus.stored_object import MAX_CONVERTED_AT_ONCE
from pacinian.serving.ipc.messages import Changes, PutObject, RemoveObject, ResetScene, SetEnvelope

if TYPE_CHECKING:
    from pacinian.serving.bus.message_admission import BusSession
    from pacinian.serving.bus.shared_scene import SharedScene
    from pacinian.serving.ipc.messages import AnyChange, ChangesAck
    from pacinian.wire.replies import Error

MAX_BATCH_OBJECTS = 64  # maximum number of objects in one batch
# Maximum number of moves, removals and new envelopes in a batch while objects wait to be put.
MAX_LIGHT_CHANGES = 48
MAX_BATCH_BYTES = 1 << 20  # maximum size of one batch, unless a single object is larger [bytes]


class ChangeBatcher:
    """Makes batches of changes for the renderer, each only when the last was taken.

    Objects are sent in the order in which they were put, except for those that take long to convert.

    run: random, identifies this run of the bus. scene: the rendered scene. errors: clients, and the errors of their
    objects that proved invalid.
    """

    def __init__(self, run: int) -> None:
        self.run = run
        self.scene: SharedScene | None = None
        self.errors: list[tuple[BusSession, Error]] = []
        self._number = 0
        self._renderer: int | None = None
        self._unacknowledged = False

    def render(self, scene: SharedScene) -> None:
        """Render this scene from now on."""
        if scene is not self.scene:
            self.scene = scene
            self._begin()

    def acknowledge(self, taken: ChangesAck) -> None:
        """Note the last batch that the renderer took. A new renderer needs the whole scene."""
        known, self._renderer = self._renderer, taken.run
        mine = taken.bus == self.run and taken.number == self._number
        if taken.run != known and not (known is None and mine):
            self._begin()
            self._unacknowledged = False
        elif mine:
            self._unacknowledged = False

    def resend_scene(self) -> None:
        """Send the whole scene again, because the last batch could not be published."""
        self._unacknowledged = False
        self._begin()

    @property
    def has_more(self) -> bool:
        """Whether there is more to send once the last batch is taken."""
        return self.scene is not None and len(self.scene.pending) > 0

    def make_batch(self) -> Changes | None:
        """Return the next batch, which the caller must publish; None if the last was not taken or nothing is new."""
        scene = self.scene
        if self._unacknowledged or scene is None or not len(scene.pending):
            return None
        batch = Batch()
        _add_scene_settings(scene, batch)
        _add_light_changes(scene, batch)
        self._add_puts(scene, batch)
        if not batch.changes:
            return None
        self._number += 1
        self._unacknowledged = True
        return Changes(self._number, self.run, tuple(batch.changes))

    def _begin(self) -> None:
        if self.scene is not None:
            self.scene.pending.start_again(list(self.scene.objects))

    def _add_puts(self, scene: SharedScene, batch: Batch) -> None:
        pending, fresh = scene.pending, 0
        for name in list(pending.puts):
            stored = scene.objects[name]
            if batch.objects >= MAX_BATCH_OBJECTS:
                return
            if stored.heavy:
                continue  # it is still being converted
            if stored.item is not None:
                fresh += 1
                if fresh > MAX_CONVERTED_AT_ONCE:
                    return
                if (error := scene.pack(stored)) is not None:
                    self.errors.append((stored.owner, error))
                    continue
            if not batch.fits(len(stored.packed)):
                return
            if pending.puts.pop(name):
                batch.changes.append(RemoveObject(name))
            batch.changes.append(PutObject(name, stored.packed, stored.default))
            pending.known.add(name)
            if (move := stored.make_move()) is not None:
                batch.changes.append(move)
            if stored.envelope and batch.fits(len(stored.envelope)):
                batch.changes.append(SetEnvelope(name, stored.envelope))
            elif stored.envelope:
                pending.note_changed(name, NEW_ENVELOPE)
            batch.objects += 1


class Batch:
    """Changes gathered for one batch. objects: number of changed objects; hands and zones do not count."""

    def __init__(self) -> None:
        self.changes: list[AnyChange] = []
        self.objects = 0
        self._size = 0

    def fits(self, size: int) -> bool:
        """Add `size` bytes if they fit; return whether they do. The first always fit."""
        if self._size and self._size + size > MAX_BATCH_BYTES:
            return False
        self._size += size
        return True


def _add_scene_settings(scene: SharedScene, batch: Batch) -> None:
    pending = scene.pending
    if pending.begin:
        batch.changes.append(ResetScene(scene.number))
    if pending.quiet:
        batch.changes.append(scene.merge_zones())
    if pending.hands:
        batch.changes.append(scene.merge_hands())
    pending.begin = pending.quiet = pending.hands = False


def _add_light_changes(scene: SharedScene, batch: Batch) -> None:
    pending = scene.pending
    for name in list(
        islice(pending.light, MAX_LIGHT_CHANGES if pending.puts else MAX_BATCH_OBJECTS)
    ):
        what, stored = pending.light[name], scene.objects.get(name)
        if stored is None:
            pending.known.discard(name)
            batch.changes.append(RemoveObject(name))
        else:
            if what & NEW_ENVELOPE:
                if not batch.fits(len(stored.envelope)):
                    return
                batch.changes.append(SetEnvelope(name, stored.envelope))
            if what & MOVED and (move := stored.make_move()) is not None:
                batch.changes.append(move)
        del pending.light[name]
        batch.objects += 1
