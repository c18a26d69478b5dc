"""Slow conversions, done one after another in a thread, so that commands do not wait for them."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections import deque
from typing import TYPE_CHECKING

import msgspec

from pacinian.errors import WireError, describe_error
from pacinian.serving.bus.stored_object import encode_object, make_error_reply
from pacinian.wire.convert import envelope_to_scene
from pacinian.wire.replies import Ok

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from concurrent.futures import Executor, Future

    from pacinian.serving.bus.message_admission import BusSession
    from pacinian.serving.bus.stored_object import StoredObject
    from pacinian.wire.modulation import Envelope
    from pacinian.wire.replies import Reply

Converted = list[tuple["StoredObject", bytes]]


class Job(ABC):
    """The slow conversion for one command. objects: those that wait for it. id: of the command; 0: no reply."""

    def __init__(self, objects: list[StoredObject], client: BusSession, id: int) -> None:  # noqa: A002
        self.objects, self.client, self.id = objects, client, id

    def trim(self) -> bool:
        """Drop the objects that are gone or have something newer; return whether any are left."""
        self.objects = [stored for stored in self.objects if self.is_awaited(stored)]
        return bool(self.objects)

    @abstractmethod
    def is_awaited(self, stored: StoredObject) -> bool:
        """Whether this job is still the newest for the object."""

    @abstractmethod
    def work(self, most: float) -> Converted:
        """Convert for the objects that still wait. most: maximum radiation pressure [Pa]. Raises WireError."""

    @abstractmethod
    def take(self, stored: StoredObject, packed: bytes) -> None:
        """Store the result for an object that still waits."""

    @abstractmethod
    def fail(self) -> None:
        """Undo the command, because it is invalid."""


class ObjectConversion(Job):
    """Converts objects that were put. drop: removes objects from their scene."""

    def __init__(
        self, objects: list[StoredObject], client: BusSession, id: int, drop: Callable[[list[StoredObject]], None]  # noqa: A002
    ) -> None:  # fmt: skip
        super().__init__(objects, client, id)
        self._drop = drop

    def is_awaited(self, stored: StoredObject) -> bool:
        """Whether the object is in the scene and not converted yet."""
        return stored.item is not None

    def work(self, most: float) -> Converted:
        """Convert the objects that are still in the scene. Raises WireError."""
        items = [(t, t.item) for t in self.objects]
        return [
            (t, encode_object(t.name, item, t.seen, most)) for t, item in items if item is not None
        ]

    def take(self, stored: StoredObject, packed: bytes) -> None:
        """Store the encoded object, which can be sent now."""
        stored.accept(packed)

    def fail(self) -> None:
        """Remove all objects of the command."""
        self._drop(self.objects)


class EnvelopeConversion(Job):
    """Converts a new envelope for objects of the scene. changed: takes the name of each object that has it."""

    def __init__(
        self, objects: list[StoredObject], client: BusSession, id: int, envelope: Envelope,  # noqa: A002
        changed: Callable[[str], None],
    ) -> None:  # fmt: skip
        super().__init__(objects, client, id)
        self._envelope: Envelope = envelope
        self._changed = changed

    def is_awaited(self, stored: StoredObject) -> bool:
        """Whether no newer envelope has arrived."""
        return stored.envelope_job is self

    def work(self, most: float) -> Converted:
        """Convert the envelope. Raises WireError."""
        packed = msgspec.msgpack.encode(envelope_to_scene(self._envelope))
        return [(stored, packed) for stored in self.objects]

    def take(self, stored: StoredObject, packed: bytes) -> None:
        """Set the new envelope."""
        stored.set_envelope(packed)
        self._changed(stored.name)

    def fail(self) -> None:
        """Keep the old envelopes."""
        for stored in self.objects:
            if self.is_awaited(stored):
                stored.set_envelope(stored.envelope)


class Converter:
    """A queue of conversion jobs, without superseded ones. most: maximum radiation pressure [Pa]."""

    def __init__(self, most: float, executor: Executor) -> None:
        self._most, self._executor = most, executor
        self._waiting: deque[Job] = deque()
        self._running: tuple[Job, Future[Converted]] | None = None
        self._ended: list[tuple[BusSession, Reply]] = []

    def __len__(self) -> int:
        return len(self._waiting) + (self._running is not None)

    def queue(self, job: Job) -> None:
        """Queue a job. Older jobs that it supersedes completely are dropped, and answered as done."""
        kept = deque([old for old in self._waiting if old.trim()])
        if len(kept) < len(self._waiting):
            for old in self._waiting:
                if not old.objects:
                    self._end(old, None)
        self._waiting = kept
        kept.append(job)

    def run_round(self) -> Iterator[tuple[BusSession, Reply]]:
        """Start the next job if the last has ended; yield the replies."""
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
        """Finish a job that is converted or superseded."""
        try:
            for stored, packed in future.result() if future is not None else ():
                if job.is_awaited(stored):
                    job.take(stored, packed)
        except Exception as error:  # whatever a conversion raises, the bus must go on
            job.fail()
            wrong = error if isinstance(error, WireError) else WireError(describe_error(error), "$")
            self._ended.append((job.client, make_error_reply(wrong, job.id)))
            return
        if job.id:
            self._ended.append((job.client, Ok(id=job.id)))
