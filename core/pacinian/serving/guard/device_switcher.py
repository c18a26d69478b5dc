"""The guard's devices: opened and closed in threads, so that the one that sounds goes on meanwhile."""

from __future__ import annotations

import functools
import itertools
import queue
from contextlib import suppress
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple, cast

from pacinian.errors import BackendError, describe_error
from pacinian.rendering.clock import SystemClock
from pacinian.scene.file import Choice as Configured
from pacinian.serving.ipc import plugin_list
from pacinian.serving.ipc.messages import check_rate
from pacinian.serving.ipc.scheduling import raise_priority, start_background_thread

if TYPE_CHECKING:
    from collections.abc import Callable

    from pacinian.acoustics.array import Array
    from pacinian.plugins.backend import Backend, Capability
    from pacinian.rendering.clock import Clock
    from pacinian.serving.guard.watchdog import OutputGate
    from pacinian.serving.ipc.messages import RequestedSettings
    from pacinian.wire.control import Choice

MAX_RESULTS = 16  # results
OPENING = (
    8.0  # [s] for a device to open; a client waits for 10 s, and is to be told why there is none
)
MAX_HANGING = 4  # threads in devices that were given up: only the process's end takes them away
AGAIN, PAUSE = (
    1.0,
    0.02,
)  # [s] in which a device that another process has just left is tried again; between two tries
SUPERSEDED = "another one was selected since"


class Opened(NamedTuple):
    """What became of orders. problem: why there is no backend."""

    orders: tuple[str, ...]
    choice: Choice | Configured
    device: tuple[Backend, Capability] | None = None
    problem: str = ""


@dataclass(eq=False)
class Opening:
    """A device that a thread opens.

    olds: are closed first. left: what another process left, which may sound; to be opened and closed first. since: when
    it began [s]. until: so long it is tried again [s].
    """

    orders: tuple[str, ...]
    choice: Choice | Configured
    olds: list[Backend]
    left: Configured | None
    since: float
    until: float


class PendingOpen:
    """What is to be opened next. choice: that was selected by `order`; None: what there was.

    resets: orders that wait for it, too. olds: are closed first.
    """

    def __init__(self) -> None:
        self.choice: Choice | Configured | None = None
        self.order = ""
        self.resets: list[str] = []
        self.olds: list[Backend] = []

    @property
    def orders(self) -> tuple[str, ...]:
        """All of them."""
        return (self.order, *self.resets) if self.order else tuple(self.resets)


class DeviceSwitcher:
    """Gives a guard its devices, as ordered: one is opened at a time, and of those that wait only the newest.

    choice: what to begin with. array: what they stand for. rate: of the loop [Hz]. make, thread, clock: for tests.

    One that has not opened within `OPENING` is given up: what its thread has opened in the end is closed, and never
    sounds.
    """

    def __init__(
        self,
        guard: OutputGate,
        array: Array,
        choice: Choice | Configured,
        rate: float,
        make: Callable[[Choice | Configured], Backend] | None = None,
        thread: Callable[[Callable[[], None]], object] | None = None,
        clock: Clock | None = None,
    ) -> None:
        self.results: dict[str, str] = {}
        self._guard, self._array, self._choice = guard, array, choice
        self._rate = rate
        self._owners = choice
        self._make = make or functools.partial(_make_backend, configured=choice)
        self._thread = thread or functools.partial(start_background_thread, name="device")
        self._clock = clock or SystemClock()
        self._opened: queue.SimpleQueue[tuple[Opening, Opened]] = queue.SimpleQueue()
        self._selected = self._reset = 0  # the last order of each kind
        self._opening: Opening | None = None
        self._hanging = 0  # were given up, and have not come back
        self._left: Configured | None = None
        self._again = 0.0  # [s] for which the next one that is opened is tried again
        self._choices: dict[int, Configured] = {}  # by generation
        self._next = PendingOpen()  # once none is being opened
        self._coming: dict[
            int, tuple[str, ...]
        ] = {}  # generation to orders: wait for the first frame

    def begin(self, orders: RequestedSettings, left: Configured | None = None) -> None:
        """Open the first one: what was selected before the guard was started anew, or as configured.

        left: what a guard before this one had, which may sound still, and be held by the system for a moment.
        """
        self._reset = orders.reset
        self._selected, selected = orders.backend
        self._choice = selected or self._choice
        if left is not None:
            self._choices[0] = left
        self._left, self._again = left, AGAIN if left else 0.0
        self._select(f"backend {self._selected}", self._choice)

    @property
    def choice(self) -> Configured | None:
        """What the guard's device is of; what was left where it has none yet."""
        return self._choices.get(self._guard.generation)

    def follow(self, orders: RequestedSettings) -> None:
        """Do what is new in the orders."""
        number, choice = orders.backend
        if number != self._selected and choice is not None:
            self._selected = number
            self._select(f"backend {number}", choice)
        if orders.reset != self._reset:
            self._reset = orders.reset
            self._mend(f"reset {self._reset}")

    def _select(self, order: str, choice: Choice | Configured) -> None:
        if self._next.order:
            self._done(self._next.order, SUPERSEDED)
        self._next.order, self._next.choice = order, choice
        self._open()

    def _mend(self, order: str) -> None:
        """After a fault: the device that waits, or the one there was, opened anew."""
        guard = self._guard
        if guard.fault and guard.coming is None:
            self._next.resets.append(order)
            if (old := guard.release()) is not None:
                self._next.olds.append(old)
            self._open()
            return
        if guard.fault:
            guard.switch()
            guard.clear()
        self._done(order)

    def poll(self) -> None:
        """Take what has been opened, close what has been left."""
        guard = self._guard
        while not self._opened.empty():
            self._came(*self._opened.get())
        now, opening = self._clock.now(), self._opening
        if opening is not None and now - opening.since > OPENING:
            self._hanging += 1
            problem = f"{opening.choice.name}: does not open within {OPENING:g} s, and is given up"
            self._take(Opened(opening.orders, opening.choice, problem=problem))
        for order in self._coming.pop(guard.generation, ()):  # which has got its first frame
            self._done(order)
        while guard.leaving:
            self._thread(functools.partial(self._close, guard.leaving.pop()))

    def _came(self, opening: Opening, opened: Opened) -> None:
        if opening is self._opening:
            self._take(opened)
            return
        self._hanging -= 1
        if opened.device is not None:
            self._guard.leaving.append(opened.device[0])

    def _take(self, opened: Opened) -> None:
        guard, (orders, choice, device, problem) = self._guard, opened
        self._opening = None
        if device is None:
            for order in orders:
                self._done(order, problem)
            if guard.backend is None:
                guard.clear()
                guard.fail(problem)
        else:
            if guard.backend is not None and self._next.order:
                guard.leaving.append(device[0])
                for order in orders:
                    self._done(order, SUPERSEDED)
            else:
                for late in itertools.chain(*self._coming.values()):
                    self._done(late, SUPERSEDED)
                self._choice = choice
                generation = guard.take(*device)
                self._coming = {generation: orders}
                self._choices = {n: c for n, c in self._choices.items() if n == guard.generation}
                self._choices[generation] = self._configured(choice)
            if any(order.startswith("reset") for order in orders):
                guard.clear()
        self._open()

    def _done(self, order: str, problem: str = "") -> None:
        self.results[order] = problem
        self._guard.changed = True
        for old in list(self.results)[:-MAX_RESULTS]:
            del self.results[old]

    def _open(self) -> None:
        """Begin with what is next, unless one is being opened."""
        ahead, guard = self._next, self._guard
        if self._opening is not None or not ahead.orders:
            return
        self._next = PendingOpen()
        if ahead.choice is None and guard.backend is not None:  # one that was selected is there now
            guard.leaving += ahead.olds
            guard.clear()
            for order in ahead.resets:
                self._done(order)
            return
        choice, now = ahead.choice or self._choice, self._clock.now()
        opening = Opening(ahead.orders, choice, ahead.olds, self._left, now, now + self._again)
        self._opening, self._left, self._again = opening, None, 0.0
        if self._hanging >= MAX_HANGING:
            guard.leaving += ahead.olds
            problem = f"{self._hanging} devices hang while they are opened: restart the server"
            self._take(Opened(ahead.orders, choice, problem=problem))
            return
        self._thread(functools.partial(self._work, opening))

    def _work(self, opening: Opening) -> None:
        """Open a device; in a thread."""
        for old in opening.olds:
            self._close(old)
        if opening.left is not None:
            raise_priority()  # nobody can end its sound but by this
        if opening.left not in (None, self._configured(opening.choice)):
            device = self._tried(opening, opening.left).device
            if device is not None:
                self._close(device[0])
        self._opened.put((opening, self._tried(opening, opening.choice)))

    def _tried(self, opening: Opening, choice: Choice | Configured) -> Opened:
        """What comes of opening a device, again and again until it was opened, or there is no more time."""
        while True:
            opened = self._once(opening, choice)
            if (
                opened.device is not None
                or opening is not self._opening
                or self._clock.now() >= opening.until
            ):
                return opened
            self._clock.wait_until(self._clock.now() + PAUSE)

    def _configured(self, choice: Choice | Configured) -> Configured:
        """The same as the owner would write it, with the options that the owner gave."""
        given = choice if isinstance(choice, Configured) else None
        owners = self._owners.options if given is None and choice.name == self._owners.name else {}
        return given or Configured(choice.name, {**owners, **choice.options})

    def _close(self, backend: Backend) -> None:
        with suppress(
            Exception
        ):  # it was silenced before, or is faulty: a reset says what is wrong
            backend.close()
        self._guard.closed(backend)

    def _once(self, opening: Opening, choice: Choice | Configured) -> Opened:
        """What comes of opening a device, which nobody wants any more if it was given up meanwhile."""
        backend, orders = None, opening.orders
        try:
            backend = self._make(choice)
            can = backend.capability
            check_rate(can.rate, self._rate)
            if opening is not self._opening:
                raise BackendError(SUPERSEDED)
            backend.open(self._array)
        except BaseException as error:  # whatever a plug-in raises ends here, not in the thread
            if backend is not None:
                self._close(backend)
            return Opened(orders, choice, problem=f"{choice.name}: {describe_error(error)}")
        return Opened(orders, choice, (backend, can))


def import_backend(choice: Choice | Configured) -> None:
    """Import the plug-in of a backend. Raises UnknownPlugin, PluginError."""
    plugin_list.find_plugin("backend", choice.name)


def _make_backend(choice: Choice | Configured, configured: Choice | Configured) -> Backend:
    return cast("Backend", plugin_list.make_plugin("backend", choice, configured))
