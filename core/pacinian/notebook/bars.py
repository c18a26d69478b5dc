"""How far a run is: a bar in a terminal, or below the cell of a notebook."""

from __future__ import annotations

import sys
import time
from contextlib import contextmanager
from html import escape
from typing import TYPE_CHECKING, Any, Protocol

if TYPE_CHECKING:
    from collections.abc import Callable, Generator

    from pacinian.rendering.report import Report

REFRESH = 0.5  # [s] between two looks of the bar, by the loop's own thread
PAGE = "ZMQInteractiveShell"  # IPython's shell behind a notebook


class Bar(Protocol):
    """A bar that is shown already."""

    def show(self, done: float, state: str) -> None:
        """So far [s]."""
        ...

    def end(self) -> None:
        """It stays as it is."""
        ...


@contextmanager
def progress(
    what: str, seconds: float, clock: Callable[[], float] = time.perf_counter
) -> Generator[Callable[[Report], object]]:
    """A bar while the `with` lasts; it gives the `on_tick` for a `Renderer.run` of so many seconds [s].

    In a terminal it is on standard error. clock: steady, [s].
    """
    bar: Bar = Page(what, seconds) if _in_notebook() else Terminal(what, seconds)
    begin = seen = clock()
    state = ""

    def on_tick(report: Report) -> None:
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


class Terminal:
    """On standard error, with the time that is left."""

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
        """So far [s]."""
        self._bar.update(self._task, completed=done, state=state)
        self._bar.refresh()

    def end(self) -> None:
        """It stays as it is."""
        self._bar.stop()


class Page:
    """In the output of a notebook's cell."""

    def __init__(self, what: str, seconds: float) -> None:
        from IPython import display

        show: Any = display.display
        self._what, self._seconds = what, seconds
        self._handle: Any = show(self._drawn(0.0, ""), raw=True, display_id=True)

    def show(self, done: float, state: str) -> None:
        """So far [s]."""
        self._handle.update(self._drawn(done, state), raw=True)

    def end(self) -> None:
        """It stays as it is."""

    def _drawn(self, done: float, state: str) -> dict[str, str]:
        text = f"{self._what}: {done:.1f} of {self._seconds:.1f} s"
        text += f", {state}" if state else ""
        bar = f'<progress max="{self._seconds:.3f}" value="{done:.3f}"></progress>'
        return {"text/plain": text, "text/html": f"<div>{bar} {escape(text)}</div>"}


def _in_notebook() -> bool:
    if "IPython" not in sys.modules:
        return False
    from IPython import get_ipython

    return type(get_ipython()).__name__ == PAGE
