"""What takes long to convert: one after another in another thread, so that commands do not wait for it."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections import deque
from typing import TYPE_CHECKING

import msgspec

from pacinian.errors import WireError, describe_error
from pacinian.serving.bus.pending_changes import WRAPPED
from pacinian.serving.bus.stored_object import encode_object, make_error_reply
from pacinian.wire.convert import envelope_to_scene
from pacinian.wire.replies import Ok

if TYPE_CHECKING:
    from collections.abc import Iterator
    from concurrent.futures import Executor, Future

    from pacinian.serving.bus.admission import Client
    from pacinian.serving.bus.shared_scene import SharedScene
    from pacinian.serving.bus.stored_object import StoredObject
    from pacinian.wire.replies import Reply
    from pacinian.wire.time import Envelope

Converted = list[tuple["StoredObject", bytes]]


class Job(ABC):
    """What one command asks for that takes long. things: those that wait for it."""

    def __init__(
        self,
        room: SharedScene,
        things: list[StoredObject],
        client: Client,
        id: int,  # noqa: A002
    ) -> None:
        self.scene, self.objects, self.client, self.id = room, things, client, id

    def trim(self) -> bool:
        """Without what is gone, or has something newer in its place; whether anything is left."""
        self.objects = [thing for thing in self.objects if self.awaited(thing)]
        return bool(self.objects)

    @abstractmethod
    def awaited(self, thing: StoredObject) -> bool:
        """Whether this is still the newest that came for it."""

    @abstractmethod
    def work(self, most: float) -> Converted:
        """Convert for those that still wait. most: radiation pressure [Pa]. Raises WireError."""

    @abstractmethod
    def take(self, thing: StoredObject, packed: bytes) -> None:
        """What came of it, for one that still waits."""

    @abstractmethod
    def fail(self) -> None:
        """It cannot be meant."""


class ObjectConversion(Job):
    """Objects that were put."""

    def awaited(self, thing: StoredObject) -> bool:
        """Whether it is there, and not converted."""
        return thing.item is not None

    def work(self, most: float) -> Converted:
        """Convert those that are still there. Raises WireError."""
        items = [(t, t.item) for t in self.objects]
        return [
            (t, encode_object(t.name, item, t.seen, most)) for t, item in items if item is not None
        ]

    def take(self, thing: StoredObject, packed: bytes) -> None:
        """It can be sent now."""
        thing.accept(packed)

    def fail(self) -> None:
        """None of them is there."""
        self.scene.drop(self.objects)


class EnvelopeConversion(Job):
    """A new envelope for objects that are there."""

    def __init__(
        self, room: SharedScene, things: list[StoredObject], client: Client, id: int, envelope: Envelope  # noqa: A002
    ) -> None:  # fmt: skip
        super().__init__(room, things, client, id)
        self._envelope: Envelope = envelope

    def awaited(self, thing: StoredObject) -> bool:
        """Whether no other came since."""
        return thing.wraps is self

    def work(self, most: float) -> Converted:
        """Convert it. Raises WireError."""
        packed = msgspec.msgpack.encode(envelope_to_scene(self._envelope))
        return [(thing, packed) for thing in self.objects]

    def take(self, thing: StoredObject, packed: bytes) -> None:
        """It has another envelope."""
        thing.wrap(packed)
        self.scene.pending.new(thing.name, WRAPPED)

    def fail(self) -> None:
        """They keep theirs."""
        for thing in self.objects:
            if self.awaited(thing):
                thing.wrap(thing.wrapped)


class Converter:
    """A queue of commands, in which nothing waits that is superseded. most: radiation pressure [Pa]."""

    def __init__(self, most: float, executor: Executor) -> None:
        self._most, self._executor = most, executor
        self._waiting: deque[Job] = deque()
        self._running: tuple[Job, Future[Converted]] | None = None
        self._ended: list[tuple[Client, Reply]] = []

    def __len__(self) -> int:
        return len(self._waiting) + (self._running is not None)

    def ask(self, job: Job) -> None:
        """Convert this; until then it is not sent to the renderer. What it supersedes is dropped, and done."""
        kept = deque([old for old in self._waiting if old.trim()])
        if len(kept) < len(self._waiting):
            for old in self._waiting:
                if not old.objects:
                    self._end(old, None)
        self._waiting = kept
        kept.append(job)

    def round(self) -> Iterator[tuple[Client, Reply]]:
        """Begin the next if the last has ended; what is to be answered."""
        while True:
            yield from self._ended
            self._ended.clear()
            if self._running is None:
                if not self._waiting:
                    return
                job = self._waiting.popleft()
                self._running = job, self._executor.submit(job.work, self._most)
            job, future = self._running
            if not future.done():
                return
            self._running = None
            self._end(job, future)

    def _end(self, job: Job, future: Future[Converted] | None) -> None:
        """It has been converted, or is superseded."""
        try:
            for thing, packed in future.result() if future is not None else ():
                if job.awaited(thing):
                    job.take(thing, packed)
        except Exception as error:  # whatever it is, the bus goes on
            job.fail()
            wrong = error if isinstance(error, WireError) else WireError(describe_error(error), "$")
            self._ended.append((job.client, make_error_reply(wrong, job.id)))
            return
        if job.id:
            self._ended.append((job.client, Ok(id=job.id)))
