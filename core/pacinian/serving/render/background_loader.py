"""Objects that take long to load, in a thread: a mesh of 20,000 triangles takes 0.2 s until it can be felt."""

from __future__ import annotations

import functools
import gc
import math
import queue
import threading
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from msgspec.msgpack import Decoder

from pacinian.errors import describe_error
from pacinian.scene.modulation.envelope import Envelope, Noise, Timed, Wave, resolve
from pacinian.scene.objects import Body, Object, Particles, Path, Point
from pacinian.scene.shapes.planar import Disc, Rectangle
from pacinian.scene.shapes.sphere_capsule import Sphere
from pacinian.serving.ipc.scheduling import start_background_thread

if TYPE_CHECKING:
    from collections.abc import Callable

LIGHT = 1 << 14  # [bytes]; what is shorter is decoded at once
QUICK = Sphere, Disc, Rectangle  # shapes of which nothing is kept
SLOW = Noise, Wave  # envelopes of which much is
COARSE = 0.02  # [m]

_objects: Decoder[Object] = Decoder(Object)
_envelopes: Decoder[Envelope] = Decoder(Envelope)


class Loaded(NamedTuple):
    """What has come of a job: what was made, or why not."""

    name: str
    turn: int
    made: Object | Timed | None
    problem: str = ""


class BackgroundLoader:
    """Makes objects and envelopes in order, one after the other: of each name only the newest. thread: for tests."""

    def __init__(self, thread: Callable[[Callable[[], None]], object] | None = None) -> None:
        self._jobs: dict[str, tuple[int, Callable[[], Object | Timed]]] = {}
        self._some, self._done = threading.Condition(), queue.SimpleQueue[Loaded]()
        self._thread, self._started = (
            thread or functools.partial(start_background_thread, name="loader"),
            False,
        )

    def __len__(self) -> int:
        """How many wait."""
        return len(self._jobs)

    def ask(self, name: str, turn: int, job: Callable[[], Object | Timed]) -> None:
        """Do this, in place of what waits for that name. turn: which it is."""
        with self._some:
            self._jobs[name] = turn, job
            self._some.notify()
        if not self._started:
            self._started = True
            self._thread(self._work)

    def drop(self, name: str) -> None:
        """What waits for that name is not wanted any more."""
        with self._some:
            self._jobs.pop(name, None)

    def done(self) -> list[Loaded]:
        """What has been done since this was last asked."""
        found: list[Loaded] = []
        while not self._done.empty():
            found.append(self._done.get())
        return found

    def _work(self) -> None:
        while True:
            self._one()

    def _one(self) -> None:
        with self._some:
            self._some.wait_for(lambda: self._jobs)
            name = next(iter(self._jobs))
            turn, job = self._jobs.pop(name)
        gc.disable()  # a search among so many new things takes longer than a tick
        try:
            self._done.put(Loaded(name, turn, job()))
        except Exception as error:  # what cannot be loaded is told, and the thread goes on
            self._done.put(Loaded(name, turn, None, describe_error(error)))
        gc.freeze()
        gc.enable()


def decode_object(data: bytes) -> Object:
    """The object. Raises msgspec.DecodeError, msgspec.ValidationError."""
    return _objects.decode(data)


def decode_envelope(data: bytes) -> Timed:
    """The envelope. Raises msgspec.DecodeError, msgspec.ValidationError."""
    return resolve(_envelopes.decode(data))


def is_light(item: Object) -> bool:
    """Whether it can be felt at once: nothing of it is made at first use that takes long."""
    if isinstance(item.envelope, SLOW):
        return False
    if isinstance(item, (Point, Path, Particles)):
        return True
    return isinstance(item.shape, QUICK) and item.texture is None


def load_object(item: Object) -> Object:
    """The object, ready to be felt. Raises ArgumentError."""
    for _ in item.load():
        pass
    load_envelope(resolve(item.envelope))
    if isinstance(item, Body):
        points = np.zeros((1, 3))
        item.distance(points, math.inf, math.inf)
        item.distance(points, item.thickness, item.thickness)
        item.sample_surface(max(COARSE, item.bounding_radius / 10.0))
    return item


def load_envelope(envelope: Timed) -> Timed:
    """The envelope, ready to be followed. Raises ArgumentError."""
    envelope.at(np.zeros(1))
    return envelope
