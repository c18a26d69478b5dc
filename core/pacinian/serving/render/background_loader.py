"""Background loading of slow objects: a mesh of 20,000 triangles takes 0.2 s to prepare."""

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
from pacinian.scene.shapes.box_disc_rectangle import Disc, Rectangle
from pacinian.scene.shapes.sphere_capsule import Sphere
from pacinian.serving.ipc.scheduling import start_background_thread

if TYPE_CHECKING:
    from collections.abc import Callable

# Size below which data is decoded at once [bytes].
MAX_LIGHT_BYTES = 1 << 14
QUICK = Sphere, Disc, Rectangle  # shapes that prepare no cache at first use
SLOW = Noise, Wave  # envelopes that prepare a large cache at first use
MIN_TRIAL_SPACING = 0.02  # minimum spacing of the trial samples [m]

_objects: Decoder[Object] = Decoder(Object)
_envelopes: Decoder[Envelope] = Decoder(Envelope)


class Loaded(NamedTuple):
    """The result of a job, or the reason why it failed."""

    name: str
    turn: int
    made: Object | Timed | None
    problem: str = ""


class BackgroundLoader:
    """Makes objects and envelopes in order, one at a time. Only the newest job of a name waits. thread: for tests."""

    def __init__(self, thread: Callable[[Callable[[], None]], object] | None = None) -> None:
        self._jobs: dict[str, tuple[int, Callable[[], Object | Timed]]] = {}
        self._some, self._done = threading.Condition(), queue.SimpleQueue[Loaded]()
        self._thread, self._started = (
            thread or functools.partial(start_background_thread, name="loader"),
            False,
        )

    def __len__(self) -> int:
        """Number of pending jobs."""
        return len(self._jobs)

    def queue(self, name: str, turn: int, job: Callable[[], Object | Timed]) -> None:
        """Queue a job; it replaces a pending one of that name. turn: number of the job."""
        with self._some:
            self._jobs[name] = turn, job
            self._some.notify()
        if not self._started:
            self._started = True
            self._thread(self._work)

    def drop(self, name: str) -> None:
        """Drop the pending job of that name."""
        with self._some:
            self._jobs.pop(name, None)

    def take_results(self) -> list[Loaded]:
        """Return the results since the last call."""
        found: list[Loaded] = []
        while not self._done.empty():
            found.append(self._done.get())
        return found

    def _work(self) -> None:
        while True:
            self._load_next()

    def _load_next(self) -> None:
        with self._some:
            self._some.wait_for(lambda: self._jobs)
            name = next(iter(self._jobs))
            turn, job = self._jobs.pop(name)
        gc.disable()  # a collection among so many new objects takes longer than a tick
        try:
            self._done.put(Loaded(name, turn, job()))
        except Exception as error:  # report what cannot be loaded; the thread must go on
            self._done.put(Loaded(name, turn, None, describe_error(error)))
        gc.freeze()
        gc.enable()


def decode_object(data: bytes) -> Object:
    """Return the object. Raises msgspec.DecodeError, msgspec.ValidationError."""
    return _objects.decode(data)


def decode_envelope(data: bytes) -> Timed:
    """Return the envelope. Raises msgspec.DecodeError, msgspec.ValidationError."""
    return resolve(_envelopes.decode(data))


def is_light(item: Object) -> bool:
    """Whether the object needs no slow preparation at first use."""
    if isinstance(item.envelope, SLOW):
        return False
    if isinstance(item, (Point, Path, Particles)):
        return True
    return isinstance(item.shape, QUICK) and item.texture is None


def load_object(item: Object) -> Object:
    """Prepare an object for rendering and return it. Raises ArgumentError."""
    for _ in item.load():
        pass
    load_envelope(resolve(item.envelope))
    if isinstance(item, Body):
        points = np.zeros((1, 3))
        item.distance(points, math.inf, math.inf)
        item.distance(points, item.thickness, item.thickness)
        item.sample_surface(max(MIN_TRIAL_SPACING, item.bounding_radius / 10.0))
        if item.texture is not None:
            item.texture.at(points)  # loads SciPy's interpolation
    return item


def load_envelope(envelope: Timed) -> Timed:
    """Prepare an envelope for rendering and return it. Raises ArgumentError."""
    envelope.at(np.zeros(1))
    return envelope
