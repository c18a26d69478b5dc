"""The guard's devices: opened and closed in threads, so that the one that sounds goes on meanwhile."""

from __future__ import annotations

import functools
import queue
import threading
from contextlib import suppress
from typing import TYPE_CHECKING, NamedTuple, cast

from pacinian.plugins import registry
from pacinian.serving.guarding import told

if TYPE_CHECKING:
    from collections.abc import Callable

    from pacinian.acoustics.array import Array
    from pacinian.plugins.backend import Backend, Capability
    from pacinian.scene.file import Choice as Configured
    from pacinian.serving.guarding import Guard
    from pacinian.serving.messages import Orders
    from pacinian.wire.control import Choice

KEPT = 16  # results
SUPERSEDED = "another one was selected since"


class Opened(NamedTuple):
    """What became of an order. turn: counts what was begun. problem: why there is no backend."""

    order: str
    turn: int
    choice: Choice | Configured
    device: tuple[Backend, Capability] | None = None
    problem: str = ""


class Devices:
    """Gives a guard its devices, as ordered.

    choice: what to begin with. array: what they stand for. make, thread: for tests.
    """

    def __init__(
        self,
        guard: Guard,
        array: Array,
        choice: Choice | Configured,
        make: Callable[[Choice | Configured], Backend] | None = None,
        thread: Callable[[Callable[[], None]], object] | None = None,
    ) -> None:
        self.results: dict[str, str] = {}
        self._guard, self._array, self._choice = guard, array, choice
        self._make, self._thread = make or _made, thread or _thread
        self._opened: queue.SimpleQueue[Opened] = queue.SimpleQueue()
        self._selected = self._reset = 0  # the last order of each kind
        self._turn = self._taken = 0
        self._coming: dict[int, str] = {}  # generation to order: wait for their first frame

    def begin(self, orders: Orders) -> None:
        """Open the first one: what was selected before the guard was started anew, or as configured."""
        self._reset = orders.reset
        self._selected, selected = orders.backend
        self._choice = selected or self._choice
        self._open(f"backend {self._selected}", self._choice)

    def follow(self, orders: Orders) -> None:
        """Do what is new in the orders."""
        number, choice = orders.backend
        if number != self._selected and choice is not None:
            self._selected = number
            self._open(f"backend {number}", choice)
        if orders.reset != self._reset:
            self._reset = orders.reset
            self._mend(f"reset {self._reset}")

    def _mend(self, order: str) -> None:
        """After a fault: the device that waits, or the one there was, opened anew."""
        guard = self._guard
        if guard.fault and guard.coming is None:
            self._open(order, self._choice, guard.release())
            return
        if guard.fault:
            guard.switch()
            guard.clear()
        self._done(order)

    def poll(self) -> None:
        """Take what has been opened, close what has been left."""
        guard = self._guard
        while not self._opened.empty():
            self._take(self._opened.get())
        if guard.generation in self._coming:  # which has got its first frame
            self._done(self._coming.pop(guard.generation))
        while guard.leaving:
            self._thread(functools.partial(_close, guard.leaving.pop()))

    def _take(self, opened: Opened) -> None:
        guard, (order, turn, choice, device, problem) = self._guard, opened
        reset = order.startswith("reset")
        if device is None:
            self._done(order, problem)
            if guard.backend is None:
                guard.clear()
                guard.fail(problem)
            return
        if turn < self._taken:
            guard.leaving.append(device[0])
            self._done(order, "" if reset else SUPERSEDED)
        else:
            for late in self._coming.values():
                self._done(late, SUPERSEDED)
            self._taken, self._choice = turn, choice
            self._coming = {guard.take(*device): order}
        if reset:
            guard.clear()

    def _done(self, order: str, problem: str = "") -> None:
        self.results[order] = problem
        self._guard.changed = True
        for old in list(self.results)[:-KEPT]:
            del self.results[old]

    def _open(self, order: str, choice: Choice | Configured, old: Backend | None = None) -> None:
        """Begin to open a device, once `old` is closed."""
        self._turn += 1
        turn = self._turn

        def work() -> None:
            if old is not None:
                _close(old)
            try:
                backend = self._make(choice)
                can = backend.capability
                backend.open(self._array)
            except BaseException as error:  # whatever a plug-in raises ends here, not in the thread
                problem = f"{choice.name}: {told(error)}"
                self._opened.put(Opened(order, turn, choice, problem=problem))
            else:
                self._opened.put(Opened(order, turn, choice, (backend, can)))

        self._thread(work)


def _made(choice: Choice | Configured) -> Backend:
    made = registry.installed().make("backend", choice.name, dict(choice.options))
    return cast("Backend", made)


def _close(backend: Backend) -> None:
    with suppress(Exception):  # it was silenced before, or is faulty: a reset says what is wrong
        backend.close()


def _thread(work: Callable[[], None]) -> None:
    threading.Thread(target=work, name="device", daemon=True).start()
