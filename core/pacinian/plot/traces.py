"""Plots the convergence of solvers over their iterations."""

from __future__ import annotations

from typing import TYPE_CHECKING, overload

from pacinian.errors import ArgumentError
from pacinian.plot.labels import label
from pacinian.plot.page import panels
from pacinian.plot.pareto_front import format_tick
from pacinian.plot.style import CURVES, LINE, MARKS, SMALL, dress
from pacinian.plugins.registry import discover_plugins, solver
from pacinian.session import Session
from pacinian.solving.solution_status import Status

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from pacinian.acoustics.air import Air
    from pacinian.acoustics.array import Array
    from pacinian.plot.labels import Text
    from pacinian.plugins.solver import Solver
    from pacinian.solving.limits import Limits
    from pacinian.types import ArrayLike

MIN_ERROR = 1e-6  # least relative error drawn, about single precision
SETTINGS = "steps", "passes"  # names of settings that limit the iterations
MAX_CLOCK_READINGS = 100_000  # maximum number of clock readings
TALL = 2.6  # [inch]
NAME_WIDTH = 6.0  # width of the axis over the most iterations, for names on the right


@overload
def convergence(
    array: Array,
    points: ArrayLike,
    amplitudes: ArrayLike,
    solvers: Sequence[str | Solver] | None = None,
    phases: ArrayLike | None = None,
    *,
    medium: Air,
    limits: Limits | None = None,
    ax: None = None,
) -> Figure: ...
@overload
def convergence(
    array: Array,
    points: ArrayLike,
    amplitudes: ArrayLike,
    solvers: Sequence[str | Solver] | None = None,
    phases: ArrayLike | None = None,
    *,
    medium: Air,
    limits: Limits | None = None,
    ax: Axes,
) -> Axes: ...
def convergence(
    array: Array,
    points: ArrayLike,
    amplitudes: ArrayLike,
    solvers: Sequence[str | Solver] | None = None,
    phases: ArrayLike | None = None,
    *,
    medium: Air,
    limits: Limits | None = None,
    ax: Axes | None = None,
) -> Figure | Axes:
    """Plot the error against the iterations of one problem, solved from a cold start with more and more iterations.

    solvers: names or objects; default: all installed ones. Solvers without iterations are dashed lines. Each solver
    defines its own iteration, so their costs differ. The rest as for `pacinian.solve`: points (M, 3) [m],
    amplitudes (M,) [Pa], phases [rad], medium. ax: to draw into and return. Raises ArgumentError, UnknownPlugin,
    MissingExtra.
    """
    chosen = list(_all() if solvers is None else solvers)
    if not chosen:
        raise ArgumentError("solvers", "must name one at least")
    page, (panel,), ours = panels(ax, [TALL])
    panel.set(xscale="log", yscale="log", xlabel="iterations", ylabel="error [%]")
    texts: list[Text] = []
    others: list[tuple[float, float]] = []
    traces = [
        dict(trace(array, points, amplitudes, one, phases, limits=limits, medium=medium))
        for one in chosen
    ]
    errors = [100.0 * max(error, MIN_ERROR) for found in traces for error in found.values()]
    panel.set_ylim(min(0.6 * min(errors), 0.1 * max(errors)), 2.5 * max(errors))
    for k, (one, found) in enumerate(zip(chosen, traces, strict=True)):
        colour, mark = CURVES[k % len(CURVES)], MARKS[k % len(MARKS)]
        x = sorted(found)
        y = [100.0 * max(found[n], MIN_ERROR) for n in x]
        name = one if isinstance(one, str) else one.name
        if x == [0]:
            panel.axhline(y[0], color=colour, linestyle="--", linewidth=LINE)
            panel.annotate(
                name, (1.0, y[0]), xycoords=panel.get_yaxis_transform(), xytext=(-3, 2),
                textcoords="offset points", ha="right", fontsize=SMALL, color=colour,
            )  # fmt: skip
        else:
            panel.plot(x, y, mark, linestyle="-", color=colour, ms=3, linewidth=LINE)
            texts.append((name, float(x[-1]), y[-1], colour))
            others += zip(map(float, x[:-1]), y[:-1], strict=True)
    panel.set_xlim(0.8, NAME_WIDTH * max((x for _, x, _, _ in texts), default=10.0))
    panel.xaxis.set_major_formatter(format_tick)
    panel.yaxis.set_major_formatter(format_tick)
    panel.grid(color="0.94", linewidth=0.5)
    if ours:
        dress(page)
    page.draw_without_rendering()  # lays the panel out, so that labels can be placed
    label(panel, texts, others)
    return page if ax is None else ax


def trace(
    array: Array,
    points: ArrayLike,
    amplitudes: ArrayLike,
    one: str | Solver,
    phases: ArrayLike | None = None,
    *,
    medium: Air,
    limits: Limits | None = None,
) -> Iterator[tuple[int, float]]:
    """Return iterations and errors of a solver that is stopped later and later.

    It is stopped by its setting `steps` or `passes` if it is named and has one, else by a clock that counts readings.
    """
    setting, most = _find_setting(one) if isinstance(one, str) else ("", 0)
    for count in _counts():
        session = Session(array, medium, one, clock=Looks())
        if setting and isinstance(one, str):
            session.solver = solver(one, **{setting: min(count, most)})
        found = session.solve(
            points, amplitudes, phases, limits=limits, deadline=None if setting else count - 0.5
        )
        yield found.iterations, found.error
        if (
            found.iterations < count or count >= most
            if setting
            else found.status is not Status.deadline
        ):
            return


class Looks:
    """A clock that advances by one second at each reading."""

    def __init__(self) -> None:
        self.seen = 0.0

    def __call__(self) -> float:
        """Return the time [s]."""
        self.seen += 1.0
        return self.seen


def _counts() -> Iterator[int]:
    """1, 2, 3, 4, 5, 6, 8, 10, 12, 15, ..."""
    count = 1
    while count < MAX_CLOCK_READINGS:
        yield count
        count = max(count + 1, round(1.25 * count))


def _find_setting(name: str) -> tuple[str, int]:
    """Return the setting that limits a solver's iterations, and its default; "" if it has none."""
    options = discover_plugins().find("solver", name).options
    for setting in SETTINGS:
        if isinstance(most := options.get(setting), int):
            return setting, most
    return "", 0


def _all() -> list[str]:
    return [offer.name for offer in discover_plugins().list() if offer.kind == "solver"]
