"""Plots run time against error, from measurements of `pacinian bench`."""

from __future__ import annotations

import json
import math
from pathlib import Path
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any, overload

from pacinian.errors import ArgumentError, RecordingError
from pacinian.plot.labels import label
from pacinian.plot.page import figure, panels, set_title
from pacinian.plot.style import BLUE, GREEN, PINK, RED, SMALL, dress

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from pacinian.plot.labels import Text
    from pacinian.plot.style import Panel

REFERENCE = "reference"  # a mode, and a family
# A fixed matrix product, which is timed to compare machines; it solves no problem.
MATRIX_PRODUCT = "gemm"
# Colour and marker of each family.
STYLES = {
    "pacinian": (BLUE, "o"),
    "autd3": (RED, "s"),
    "acoustools": (GREEN, "^"),
    "levitate": (PINK, "D"),
    REFERENCE: ("0.4", "x"),
}
MIN_FRONT_SCALE = 0.9  # scale s below which a mark is pale and not on the front
MIN_DRAWN_ERROR = 1e-5  # least error drawn; smaller ones are drawn here [%]
AXIS_END = 200.0  # largest error on the axis [%]
SHOWN_MODES = ("cold", "warm", REFERENCE)
MAX_PANELS = 4  # panels along a side
TALL = 2.8  # [inch]


Timed = Any  # one solver on one kind of problem: `pacinian_lab.solvers.summary.Cell`, or its form in a file


@overload
def pareto(
    results: str | Path | Iterable[Timed],
    *,
    level: float | None = None,
    N: int | None = None,
    M: int | None = None,
    title: str = "",
    ax: None = None,
) -> Figure: ...
@overload
def pareto(
    results: str | Path | Iterable[Timed],
    *,
    level: float | None = None,
    N: int | None = None,
    M: int | None = None,
    title: str = "",
    ax: Axes,
) -> Axes: ...
def pareto(
    results: str | Path | Iterable[Timed],
    *,
    level: float | None = None,
    N: int | None = None,
    M: int | None = None,
    title: str = "",
    ax: Axes | None = None,
) -> Figure | Axes:
    """Plot the median run time against the error, with the Pareto front.

    The error is that of the proportions, ||a - s t|| / ||s t|| with the best multiple s. A name is followed by s if s
    is not 1.

    results: the file `bench.json`, or its cells. level: of the targets; default: the lowest. N, M: numbers of
    transducers and points; default: one panel for each combination. ax: axes to draw into and return, if both are
    given. Filled marks: cold start; hollow: warm start; pale: less than 0.9 of the target strength. Errors below 1e-5 %
    are drawn at 1e-5 %. Failures, and errors above 100 %, are omitted.

    Raises ArgumentError, RecordingError, MissingExtra.
    """
    cells = select_drawn(read(results) if isinstance(results, (str, Path)) else results)
    level = min((c.level for c in cells), default=0.0) if level is None else level
    cells = [c for c in cells if c.level == level and N in (None, c.N) and M in (None, c.M)]
    if not any(c.mode != REFERENCE for c in cells):
        given = " and ".join(f"{name} = {n}" for name, n in (("N", N), ("M", M)) if n is not None)
        with_these = f" with {given}" if given else ""
        raise ArgumentError("results", f"must have a measurement at level {level:g}{with_these}")
    sizes, counts = thin_out(sorted({c.N for c in cells})), thin_out(sorted({c.M for c in cells}))
    if len(sizes) == len(counts) == 1:
        page, (panel,), ours = panels(ax, [TALL])
        grid = [[panel]]
    elif ax is not None:
        raise ArgumentError("ax", "must be left out where there are several panels: give N and M")
    else:
        page, ours = figure(1.0 + 4.4 * len(sizes), 1.0 + 3.3 * len(counts)), False
        grid = page.subplots(
            len(counts), len(sizes), sharex=True, sharey=True, squeeze=False
        ).tolist()
    _axes(grid, sizes, counts, [1e3 * c.p50 for c in cells])
    if title:
        set_title(page, title, fontsize=9)
    if ours:
        dress(page)
    page.draw_without_rendering()  # lays the panels out, so that labels can be placed
    for panels_of_count, count in zip(grid, counts, strict=True):
        for panel, size in zip(panels_of_count, sizes, strict=True):
            _draw(panel, [c for c in cells if size == c.N and count == c.M])
    return page if ax is None else ax


def read(path: str | Path) -> list[Timed]:
    """Read the cells of a `bench.json`. Raises RecordingError."""
    try:
        found = json.loads(Path(path).read_text(encoding="utf-8"))["cells"]
        cells: list[Timed] = [
            SimpleNamespace(**{k: math.nan if v is None else v for k, v in cell.items()})
            for cell in found
        ]
        for cell in cells:
            float(cell.p50 + cell.error + cell.scale + cell.level + cell.N + cell.M)
            _ = cell.family, cell.solver, cell.mode, cell.note
    except (OSError, ValueError, KeyError, TypeError, AttributeError) as error:
        problem = f"is no bench.json of `pacinian bench`: {type(error).__name__}: {error}"
        raise RecordingError(path, problem) from error
    return cells


def select_drawn(cells: Iterable[Timed]) -> list[Timed]:
    """Return the cells to draw: those that were measured, without solvers whose error is above 100 %."""
    return [
        c
        for c in cells
        if c.mode in SHOWN_MODES and c.solver != MATRIX_PRODUCT and not c.note and c.p50 > 0.0
        if c.mode == REFERENCE or c.error <= 1.0
    ]


def style(family: str) -> tuple[str, str]:
    """Return the colour and the marker of a cell."""
    return STYLES.get(family, STYLES[REFERENCE])


def format_tick(value: float, place: int) -> str:
    """Format a tick label without powers of ten."""
    return f"{value:g}"


def thin_out(values: list[int]) -> list[int]:
    """Select at most `MAX_PANELS` of the values, evenly spread, including the first and the last."""
    if len(values) <= MAX_PANELS:
        return values
    return [values[round(k * (len(values) - 1) / (MAX_PANELS - 1))] for k in range(MAX_PANELS)]


def _axes(
    grid: list[list[Panel]], sizes: list[int], counts: list[int], times: Sequence[float]
) -> None:
    """Set the scales, labels and titles of all panels."""
    for row, count in zip(grid, counts, strict=True):
        row[0].set_ylabel("error of the proportions [%]")
        for panel, size in zip(row, sizes, strict=True):
            panel.set(xscale="log", yscale="log", ylim=(0.4 * MIN_DRAWN_ERROR, AXIS_END))
            panel.set_xlim(0.6 * min(times), 8.0 * max(times))
            panel.set_title(f"N = {size} transducers, M = {count} points", fontsize=9)
            for axis in (panel.xaxis, panel.yaxis):
                axis.set_major_formatter(format_tick)
    for panel in grid[-1]:
        panel.set_xlabel("run time, p50 [ms]")


def _draw(panel: Panel, cells: list[Timed]) -> None:
    at = {(c.solver, c.mode): (1e3 * c.p50, max(100.0 * c.error, MIN_DRAWN_ERROR)) for c in cells}
    texts: list[Text] = []
    for c in cells:
        x, y = at[c.solver, c.mode]
        colour, marker = style(c.family)
        alpha = 0.4 if c.scale < MIN_FRONT_SCALE else 1.0
        if c.mode == REFERENCE:
            panel.axvline(x, color=colour, linestyle=":", linewidth=1)
            panel.text(x, 0.6 * MIN_DRAWN_ERROR, f" {c.solver}", color=colour, fontsize=SMALL)
        elif c.mode == "warm":
            panel.plot(x, y, marker, color=colour, ms=4, mfc="none", mew=0.8, alpha=alpha)
            if cold := at.get((c.solver, "cold")):
                panel.plot(*zip((x, y), cold, strict=True), color=colour, linewidth=0.5)
        else:
            panel.plot(x, y, marker, color=colour, ms=5, zorder=6, alpha=alpha)
            scale = "" if abs(c.scale - 1.0) < 0.01 else f" x{c.scale:.2f}"
            texts.append((c.solver + scale, x, y, colour))
    front = _front(
        [at[c.solver, "cold"] for c in cells if c.mode == "cold" and c.scale >= MIN_FRONT_SCALE]
    )
    if front:
        front = [(front[0][0], AXIS_END), *front, (panel.get_xlim()[1], front[-1][1])]
        panel.step(*zip(*front, strict=True), where="post", color="0.87", linewidth=3, zorder=0)
    panel.grid(color="0.94", linewidth=0.5)
    label(panel, texts, [at[c.solver, c.mode] for c in cells if c.mode == "warm"])


def _front(points: Iterable[tuple[float, float]]) -> list[tuple[float, float]]:
    """Return the Pareto front: the points that no other beats in both time and error."""
    front: list[tuple[float, float]] = []
    for at in sorted(points):
        if not front or at[1] < front[-1][1]:
            front.append(at)
    return front
