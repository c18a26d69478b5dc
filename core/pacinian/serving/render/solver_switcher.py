"""The solver switcher: makes and tries out solvers in threads while the loop runs.

A new one takes over between two ticks.
"""

from __future__ import annotations

import functools
import queue
import time
from typing import TYPE_CHECKING, NamedTuple, cast

from pacinian.errors import describe_error
from pacinian.rendering.warmup import try_out
from pacinian.scene.config_sections import PluginConfig
from pacinian.serving.ipc import plugin_list
from pacinian.serving.ipc.messages import SUPERSEDED
from pacinian.serving.ipc.scheduling import start_background_thread
from pacinian.session import Session

if TYPE_CHECKING:
    from collections.abc import Callable

    from pacinian.acoustics.air import Air
    from pacinian.acoustics.array import Array
    from pacinian.plugins.solver import Solver
    from pacinian.wire.control import Choice

# Time after which a solver that is not made yet gives way to a newer selection, because its client no longer waits [s].
MAKING = 10.0
# Number of threads that may hang in abandoned solvers; only the end of the process ends them.
MAX_HANGING = 4


class MadeSolver(NamedTuple):
    """The result of an order: a solver that passed a trial solve, or the reason why there is none."""

    order: int
    solver: Solver | None
    problem: str = ""


class SolverSwitcher:
    """Chooses the solver: the newest selected. It makes one at a time, and keeps only the newest that waits.

    chosen: the first solver. array, medium: to try out new ones. configured: with the owner's options. thread, clock:
    for tests.

    A solver that takes longer than `MAKING` gives way to the next one, because it may hang.
    """

    def __init__(
        self,
        chosen: Solver,
        array: Array,
        medium: Air | None = None,
        configured: str | PluginConfig = "",
        thread: Callable[[Callable[[], None]], object] | None = None,
        clock: Callable[[], float] = time.perf_counter,
    ) -> None:
        self.chosen = chosen
        self._configured = configured
        self._array, self._medium = array, medium
        self._thread = thread or functools.partial(start_background_thread, name="solver")
        self._made: queue.SimpleQueue[MadeSolver] = queue.SimpleQueue()
        self._clock = clock
        self._making = 0  # order number of the solver being made; 0 if none
        self._since = 0.0  # when making it began [s]
        self._hanging = 0  # number of abandoned solvers whose threads have not returned
        self._next: tuple[int, Choice] | None = None  # to make next, once none is being made
        self._results: dict[str, str] = {}

    @property
    def making(self) -> bool:
        """Whether a solver is being made, so that `poll` must be called again."""
        return bool(self._making)

    def order(self, number: int, choice: Choice) -> None:
        """Order a solver; the newest order wins."""
        if self._next is not None:
            self._results[f"solver {self._next[0]}"] = SUPERSEDED
        self._next = number, choice
        self._begin()

    def _begin(self) -> None:
        """Start to make the next solver, unless one is being made."""
        if self._making or self._next is None:
            return
        (number, choice), self._next = self._next, None
        if self._hanging >= MAX_HANGING:
            self._results[f"solver {number}"] = (
                f"{self._hanging} solvers hang while they are made: restart the server"
            )
            return
        self._making, self._since = number, self._clock()

        def work() -> None:
            # Catch whatever a plug-in raises, because an exception must not end the thread.
            try:
                solver = make_solver(choice, self._configured)
                try_out(Session(self._array, self._medium, solver))
            except BaseException as error:
                self._made.put(MadeSolver(number, None, f"{choice.name}: {describe_error(error)}"))
            else:
                self._made.put(MadeSolver(number, solver))

        self._thread(work)

    def poll(self) -> dict[str, str]:
        """Take the solvers that were made; return the results of orders."""
        while not self._made.empty():
            order, solver, problem = self._made.get()
            if order != self._making:
                self._hanging -= 1
                continue
            if solver is not None:
                problem = self._take(solver)
            self._end(problem)
        if self._making and self._next is not None and self._clock() - self._since > MAKING:
            self._hanging += 1
            self._end(f"not made within {MAKING:g} s, and {SUPERSEDED}")
        results, self._results = self._results, {}
        return results

    def _end(self, problem: str) -> None:
        """Record the result of the current order; start the next."""
        self._results[f"solver {self._making}"], self._making = problem, 0
        self._begin()

    def _take(self, solver: Solver) -> str:
        if self._next is not None:
            return SUPERSEDED
        self.chosen = solver
        return ""


def make_solver(choice: str | Choice | PluginConfig, configured: str | PluginConfig = "") -> Solver:
    """Make a solver. configured: as in `plugin_list.make_plugin`. Raises UnknownPlugin, PluginError, ArgumentError."""
    whole, owners = (PluginConfig(c) if isinstance(c, str) else c for c in (choice, configured))
    return cast("Solver", plugin_list.make_plugin("solver", whole, owners))
