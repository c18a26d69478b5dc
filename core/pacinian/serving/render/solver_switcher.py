"""The solver switcher: creates solvers and tries them out in threads while the loop runs.

The loop changes to a new solver between two ticks.
"""

from __future__ import annotations

import functools
import queue
import time
from typing import TYPE_CHECKING, NamedTuple, cast

from pacinian.errors import PluginError, describe_error
from pacinian.rendering.warmup import try_out
from pacinian.scene.config_sections import PluginConfig
from pacinian.serving.ipc import plugin_list
from pacinian.serving.ipc.messages import SUPERSEDED
from pacinian.serving.ipc.scheduling import start_background_thread
from pacinian.session import Session
from pacinian.solving.solution_status import Status

if TYPE_CHECKING:
    from collections.abc import Callable

    from pacinian.acoustics.air import Air
    from pacinian.acoustics.array import Array
    from pacinian.plugins.solver import Solver
    from pacinian.wire.control import Choice

# Time after which a solver that has not started gives way to a newer selection, because its client no longer waits [s].
START_TIMEOUT = 10.0
# Number of threads that may hang in abandoned solvers; only the end of the process ends them.
MAX_HANGING = 4


class StartedSolver(NamedTuple):
    """The result of a selection: a solver that passed a trial solve, or the reason why there is none."""

    number: int
    solver: Solver | None
    problem: str = ""


class SolverSwitcher:
    """Starts the solver that was selected last: one at a time. Of the selections that wait, it keeps only the newest.

    chosen: the first solver. array, medium: for the trial solve of a new solver. configured: the configured solver,
    with the owner's options. thread, clock: for tests.

    A solver that takes longer than `START_TIMEOUT` to start gives way to a newer selection, because it may hang.
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
        self._started: queue.SimpleQueue[StartedSolver] = queue.SimpleQueue()
        self._clock = clock
        self._starting = 0  # number of the selection whose solver is being started; 0 if none
        self._since = 0.0  # when its start began [s]
        self._hanging = 0  # number of abandoned solvers whose threads have not returned
        self._next: tuple[int, Choice] | None = None  # to start next, once none is being started
        self._results: dict[str, str] = {}

    @property
    def starting(self) -> bool:
        """Whether a solver is being started, so that `poll` must be called again."""
        return bool(self._starting)

    def select(self, number: int, choice: Choice) -> None:
        """Select a solver; the newest selection wins."""
        if self._next is not None:
            self._results[f"solver {self._next[0]}"] = SUPERSEDED
        self._next = number, choice
        self._begin()

    def _begin(self) -> None:
        """Begin to start the next solver, unless one is being started."""
        if self._starting or self._next is None:
            return
        (number, choice), self._next = self._next, None
        if self._hanging >= MAX_HANGING:
            self._results[f"solver {number}"] = (
                f"cannot start another solver, because {self._hanging} solvers hang while they start: "
                "restart the server"
            )
            return
        self._starting, self._since = number, self._clock()

        def work() -> None:
            # Catch whatever a plug-in raises, because an exception must not end the thread.
            try:
                solver = make_solver(choice, self._configured)
                trial = try_out(Session(self._array, self._medium, solver))
                if trial.status is Status.failed:
                    raise PluginError("gives gains that are not finite")
            except BaseException as error:
                self._started.put(
                    StartedSolver(number, None, f"{choice.name}: {describe_error(error)}")
                )
            else:
                self._started.put(StartedSolver(number, solver))

        self._thread(work)

    def poll(self) -> dict[str, str]:
        """Take the solvers that have started; return the results of selections."""
        while not self._started.empty():
            number, solver, problem = self._started.get()
            if number != self._starting:
                self._hanging -= 1
                continue
            if solver is not None:
                problem = self._take(solver)
            self._end(problem)
        if (
            self._starting
            and self._next is not None
            and self._clock() - self._since > START_TIMEOUT
        ):
            self._hanging += 1
            self._end(f"did not start within {START_TIMEOUT:g} s, and {SUPERSEDED}")
        results, self._results = self._results, {}
        return results

    def _end(self, problem: str) -> None:
        """Record the result of the current selection; start the next."""
        self._results[f"solver {self._starting}"], self._starting = problem, 0
        self._begin()

    def _take(self, solver: Solver) -> str:
        if self._next is not None:
            return SUPERSEDED
        self.chosen = solver
        return ""


def make_solver(choice: str | Choice | PluginConfig, configured: str | PluginConfig = "") -> Solver:
    """Create a solver. Arguments as in `plugin_list.make_plugin`. Raises UnknownPlugin, PluginError, ArgumentError."""
    whole, owners = (PluginConfig(c) if isinstance(c, str) else c for c in (choice, configured))
    return cast("Solver", plugin_list.make_plugin("solver", whole, owners))
