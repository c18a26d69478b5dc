"""Draw the pictures: run time against error, and run time against size. Needs Matplotlib."""

from __future__ import annotations

from typing import TYPE_CHECKING

from pacinian.plot import figure, pareto, save
from pacinian.plot.labels import label_column
from pacinian.plot.pareto_front import (
    MIN_DRAWN_ERROR,
    MIN_FRONT_SCALE,
    format_tick,
    select_drawn,
    style,
)
from pacinian_lab.solvers.run import REFERENCE
from pacinian_lab.solvers.summary import growth

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from matplotlib.figure import Figure

    from pacinian_lab.solvers.summary import Cell, Growth


def draw(cells: Sequence[Cell], folder: Path) -> list[Path]:
    """Draw all pictures as PNG files in `folder` and return the files. Raises MissingExtra.

    Leaves out failed cells, and cells with an error above 100 %.
    """
    pages: dict[str, Figure] = {}
    for level in sorted({c.level for c in select_drawn(cells) if c.mode != REFERENCE}):
        pages[f"pareto-{level:g}.png"] = draw_typical(cells, level)
        title = (
            f"Run time from points to gains against error, at level {level:g}. "
            f"Filled: cold; hollow: warm. x: scale, if not 1; pale: under {MIN_FRONT_SCALE:g}. "
            f"Errors under {MIN_DRAWN_ERROR:g} % are drawn at that value."
        )
        pages[f"pareto-{level:g}-all.png"] = pareto(cells, level=level, title=title)
    if lines := growth(cells):
        pages["growth.png"] = grow(lines)
    for name, page in pages.items():
        save(page, folder / name)
    return [folder / name for name in pages]


def draw_typical(cells: Sequence[Cell], level: float) -> Figure:
    """Draw run time against error on the largest array, for the middle number of points. Raises MissingExtra."""
    found = [c for c in select_drawn(cells) if c.level == level and c.mode != REFERENCE]
    N = max(c.N for c in found)
    counts = sorted({c.M for c in found if c.N == N})
    page = figure(8.0, 4.6)
    pareto(cells, level=level, N=N, M=counts[len(counts) // 2], ax=page.subplots())
    return page


def grow(lines: Sequence[Growth]) -> Figure:
    """Draw run time against N and against M. Raises MissingExtra."""
    alongs = sorted({line.along for line in lines}, reverse=True)
    page = figure(1.0 + 5.5 * len(alongs), 8.0)
    panels = page.subplots(1, len(alongs), sharey=True, squeeze=False)[0]
    for panel, along in zip(panels, alongs, strict=True):
        panel.set(xscale="log", yscale="log")
        found = [line for line in lines if line.along == along]
        for line in found:
            colour, marker = style(line.family)
            dashes = "--" if line.family == REFERENCE else "-"
            panel.plot(line.sizes, [1e3 * t for t in line.times], dashes, marker=marker, ms=4,
                       color=colour, linewidth=1)  # fmt: skip
        sizes = sorted({size for line in found for size in line.sizes})
        panel.set_xlim(0.8 * sizes[0], sizes[-1] * (sizes[-1] / sizes[0]) ** 0.55)
        panel.set_xticks(sizes, [str(size) for size in sizes])
        panel.set_xticks([], minor=True)
        panel.yaxis.set_major_formatter(format_tick)
        other, what = ("M", "transducers N") if along == "N" else ("N", "points M")
        panel.set_xlabel(what)
        panel.set_title(
            f"{other} = {found[0].fixed}; the power of {along} in each label", fontsize=9
        )
        panel.grid(color="0.93", linewidth=0.5)
    panels[0].set_ylabel("run time, p50, cold [ms]")
    page.suptitle(f"Growth of the run time at level {lines[0].level:g}", fontsize=10)
    page.draw_without_rendering()
    for panel, along in zip(panels, alongs, strict=True):
        label_column(
            panel,
            [
                (f"{line.solver}  {along}$^{{{line.exponent:.2f}}}$", line.sizes[-1],
                 1e3 * line.times[-1], style(line.family)[0])
                for line in lines
                if line.along == along
            ],
        )  # fmt: skip
    return page
