"""Objects that take long to convert: one after another in another thread, so that commands do not wait for them."""

from __future__ import annotations

from collections import deque
from typing import TYPE_CHECKING, NamedTuple

from pacinian.errors import WireError
from pacinian.serving.things import made, refused
from pacinian.wire.replies import Ok

if TYPE_CHECKING:
    from collections.abc import Iterator
    from concurrent.futures import Executor, Future

    from pacinian.serving.intake import Client
    from pacinian.serving.things import Thing
    from pacinian.serving.world import Room
    from pacinian.wire.replies import Reply


class Job(NamedTuple):
    """The objects of one command that take long."""

    room: Room
    things: list[Thing]
    client: Client
    id: int

    @property
    def superseded(self) -> bool:
        """Whether all of them are gone, or something newer is in their place."""
        return not any(self.room.has(thing) for thing in self.things)

    def work(self, most: float) -> list[tuple[Thing, bytes]]:
        """Convert those that are still there. Raises WireError."""
        items = [(t, t.item) for t in self.things if self.room.has(t)]
        return [(t, made(t.name, item, t.seen, most)) for t, item in items if item is not None]


class Converter:
    """A queue of commands, in which those that are superseded do not wait. most: radiation pressure [Pa]."""

    def __init__(self, most: float, executor: Executor) -> None:
        self._most, self._executor = most, executor
        self._waiting: deque[Job] = deque()
        self._running: tuple[Job, Future[list[tuple[Thing, bytes]]]] | None = None
        self._room = 16

    def __len__(self) -> int:
        return len(self._waiting) + (self._running is not None)

    def ask(self, job: Job) -> None:
        """Convert these; until then they are not sent to the renderer."""
        self._waiting.append(job)
        if len(self._waiting) > self._room:
            self._waiting = deque(j for j in self._waiting if j.id or not j.superseded)
            self._room = 2 * len(self._waiting) + 16

    def round(self) -> Iterator[tuple[Client, Reply]]:
        """Begin the next if the last has ended; what is to be answered."""
        while True:
            if self._running is None:
                if not self._waiting:
                    return
                job = self._waiting.popleft()
                self._running = job, self._executor.submit(job.work, self._most)
            job, future = self._running
            if not future.done():
                return
            self._running = None
            reply = _ended(job, future)
            if reply is not None:
                yield job.client, reply


def _ended(job: Job, future: Future[list[tuple[Thing, bytes]]]) -> Reply | None:
    try:
        for thing, packed in future.result():
            thing.accept(packed)
    except WireError as error:
        job.room.drop(job.things)
        return refused(error, job.id)
    return Ok(id=job.id) if job.id else None
