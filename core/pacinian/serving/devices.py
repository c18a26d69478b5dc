"""The guard's devices: opened and closed in threads, so that the one that sounds goes on meanwhile."""

from __future__ import annotations

import functools
import itertools
import queue
from contextlib import suppress
from typing import TYPE_CHECKING, NamedTuple, cast

from pacinian.errors import told
from pacinian.serving.offers import made
from pacinian.serving.output import check_rate
from pacinian.serving.priority import beside

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
    """What became of orders. problem: why there is no backend."""

    orders: tuple[str, ...]
    choice: Choice | Configured
    device: tuple[Backend, Capability] | None = None
    problem: str = ""


class Next:
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


class Devices:
    """Gives a guard its devices, as ordered: one is opened at a time, and of those that wait only the newest.

    choice: what to begin with. array: what they stand for. rate: of the loop [Hz]. make, thread: for tests.
    """

    def __init__(
        self,
        guard: Guard,
        array: Array,
        choice: Choice | Configured,
        rate: float,
        make: Callable[[Choice | Configured], Backend] | None = None,
        thread: Callable[[Callable[[], None]], object] | None = None,
    ) -> None:
        self.results: dict[str, str] = {}
        self._guard, self._array, self._choice = guard, array, choice
        self._rate = rate
        self._make = make or functools.partial(_made, configured=choice)
        self._thread = thread or functools.partial(beside, name="device")
        self._opened: queue.SimpleQueue[Opened] = queue.SimpleQueue()
        self._selected = self._reset = 0  # the last order of each kind
        self._busy = False
        self._next = Next()  # once the thread is free
        self._coming: dict[
            int, tuple[str, ...]
        ] = {}  # generation to orders: wait for the first frame

    def begin(self, orders: Orders) -> None:
        """Open the first one: what was selected before the guard was started anew, or as configured."""
        self._reset = orders.reset
        self._selected, selected = orders.backend
        self._choice = selected or self._choice
        self._select(f"backend {self._selected}", self._choice)

    def follow(self, orders: Orders) -> None:
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
            self._take(self._opened.get())
        for order in self._coming.pop(guard.generation, ()):  # which has got its first frame
            self._done(order)
        while guard.leaving:
            self._thread(functools.partial(self._close, guard.leaving.pop()))

    def _take(self, opened: Opened) -> None:
        guard, (orders, choice, device, problem) = self._guard, opened
        self._busy = False
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
                self._coming = {guard.take(*device): orders}
            if any(order.startswith("reset") for order in orders):
                guard.clear()
        self._open()

    def _done(self, order: str, problem: str = "") -> None:
        self.results[order] = problem
        self._guard.changed = True
        for old in list(self.results)[:-KEPT]:
            del self.results[old]

    def _open(self) -> None:
        """Begin with what is next, unless one is being opened."""
        ahead, guard = self._next, self._guard
        if self._busy or not ahead.orders:
            return
        self._next = Next()
        if ahead.choice is None and guard.backend is not None:  # one that was selected is there now
            guard.leaving += ahead.olds
            guard.clear()
            for order in ahead.resets:
                self._done(order)
            return
        choice, self._busy = ahead.choice or self._choice, True

        def work() -> None:
            for old in ahead.olds:
                self._close(old)
            self._opened.put(self._tried(ahead.orders, choice))

        self._thread(work)

    def _close(self, backend: Backend) -> None:
        with suppress(
            Exception
        ):  # it was silenced before, or is faulty: a reset says what is wrong
            backend.close()
        self._guard.closed(backend)

    def _tried(self, orders: tuple[str, ...], choice: Choice | Configured) -> Opened:
        """What comes of opening a device."""
        backend = None
        try:
            backend = self._make(choice)
            can = backend.capability
            check_rate(can.rate, self._rate)
            backend.open(self._array)
        except BaseException as error:  # whatever a plug-in raises ends here, not in the thread
            if backend is not None:
                self._close(backend)
            return Opened(orders, choice, problem=f"{choice.name}: {told(error)}")
        return Opened(orders, choice, (backend, can))


def _made(choice: Choice | Configured, configured: Choice | Configured) -> Backend:
    return cast("Backend", made("backend", choice, configured))
