"""Progress bars in a terminal, or below the cell of a notebook."""

from __future__ import annotations

import sys
import time
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, Protocol

from pacinian.notebook.cards import escape

if TYPE_CHECKING:
    from collections.abc import Callable, Generator

# Shortest time between redraws [s]. They run in the thread of the loop, so they cost it time.
REFRESH = 0.5
NOTEBOOK_SHELL = "ZMQInteractiveShell"  # class name of IPython's shell in a notebook


class TickCounts(Protocol):
    """What a bar shows of a run, such as a `Report`."""

    ticks: int
    late_ticks: int


class Bar(Protocol):
    """A bar on the screen."""

    def show(self, done: float, state: str) -> None:
        """Redraw the bar. done: time so far [s]. state: text beside it."""
        ...

    def end(self) -> None:
        """Stop updating the bar, which stays on the screen."""
        ...


@contextmanager
def progress(
    what: str, seconds: float, clock: Callable[[], float] = time.perf_counter
) -> Generator[Callable[[TickCounts], object]]:
    """Show a progress bar during the `with` block, which receives the `on_tick` for `Renderer.run`.

    what: title of the bar. seconds: duration of the run [s]. clock: steady clock [s]. In a terminal the bar is on
    standard error.
    """
    bar: Bar = NotebookBar(what, seconds) if _in_notebook() else TerminalBar(what, seconds)
    begin = seen = clock()
    state = ""

    def on_tick(report: TickCounts) -> None:
        nonlocal seen, state
        state = f"{report.ticks} ticks, {report.late_ticks} late"
        if (now := clock()) - seen >= REFRESH:
            seen = now
            bar.show(min(now - begin, seconds), state)

    try:
        yield on_tick
    finally:
        bar.show(min(clock() - begin, seconds), state)
        bar.end()


class TerminalBar:
    """A bar on standard error, with the remaining time."""

    def __init__(self, what: str, seconds: float) -> None:
        from rich.console import Console
        from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

        self._bar = Progress(
            TextColumn("{task.description}"),
            BarColumn(),
            TextColumn("{task.fields[state]}"),
            TimeRemainingColumn(),
            console=Console(stderr=True, force_jupyter=False),
            auto_refresh=False,
        )
        self._bar.start()
        self._task = self._bar.add_task(what, total=seconds, state="")

    def show(self, done: float, state: str) -> None:
        """Redraw the bar. done: time so far [s]. state: text beside it."""
        self._bar.update(self._task, completed=done, state=state)
        self._bar.refresh()

    def end(self) -> None:
        """Stop updating the bar, which stays on the screen."""
        self._bar.stop()


class NotebookBar:
    """A bar in the output of a notebook cell."""

    def __init__(self, what: str, seconds: float) -> None:
        from IPython import display

        show: Any = display.display
        self._what, self._seconds = what, seconds
        self._handle: Any = show(self._drawn(0.0, ""), raw=True, display_id=True)

    def show(self, done: float, state: str) -> None:
        """Redraw the bar. done: time so far [s]. state: text beside it."""
        self._handle.update(self._drawn(done, state), raw=True)

    def end(self) -> None:
        """Do nothing: the bar stays on the page."""

    def _drawn(self, done: float, state: str) -> dict[str, str]:
        text = f"{self._what}: {done:.1f} of {self._seconds:.1f} s"
        text += f", {state}" if state else ""
        bar = f'<progress max="{self._seconds:.3f}" value="{done:.3f}"></progress>'
        return {"text/plain": text, "text/html": f"<div>{bar} {escape(text)}</div>"}


def _in_notebook() -> bool:
    if "IPython" not in sys.modules:
        return False
    from IPython import get_ipython

    return type(get_ipython()).__name__ == NOTEBOOK_SHELL
