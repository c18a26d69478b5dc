"""Charts of the measures: by layout, and against the layouts' dimensions."""

from __future__ import annotations

from collections import defaultdict
from statistics import median
from typing import TYPE_CHECKING

import numpy as np

from pacinian.plot.page import figure, save
from pacinian.plot.pareto_front import format_tick
from pacinian.plot.style import CURVES, MARKS, SMALL, Panel
from pacinian_lab.study.images import LAYOUTS, PLANES, SMALL_FONT
from pacinian_lab.study.measures import MEASURES

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence
    from pathlib import Path

    from pacinian_lab.study.worker import Row

# The measures of the charts, and what each chart tells.
MESSAGES = {
    "width_across_x": "detail: smaller is finer",
    "width_along": "depth: smaller is finer",
    "efficiency": "energy in the pattern: more is better",
    "side_lobe": "loudest stray lobe: less is better",
    "contrast": "contrast: more is better",
    "yield": "pressure per watt: more is better",
}
AGAINST = ("aperture", "spacing", "transducers")
ACROSS = 3  # panels per row
TIE = 1e-3  # relative difference up to which two medians are equally good
SCALES = {"m": (1e3, "mm"), "Pa": (1e-3, "kPa")}  # units that are drawn in another unit
LOGARITHMIC = ("yield", "shape_error", "condition", "width_along", "width_across_x", *AGAINST)


def measures(rows: Sequence[Row], path: Path) -> None:
    """Draw each measure by layout: a dot for every task, a mark at the median, a colour for each plane.

    A ring is around the best median of the first plane, or around all that differ from it by at most `TIE`.
    """
    at = _group_rows(rows)
    names, planes = (list(dict.fromkeys(labels)) for labels in zip(*at, strict=True))
    names.reverse()
    tall = 0.9 + 0.11 * len(names) * max(2, len(planes)) ** 0.5
    down = -(-len(MESSAGES) // ACROSS)
    page = figure(2.2 + 2.4 * ACROSS, 0.6 + 1.1 * tall * down)
    grid = page.subplots(down, ACROSS, sharey=True, squeeze=False)
    for panel, (measure, message) in zip(grid.ravel(), MESSAGES.items(), strict=True):
        panel.set_title(message, fontsize=SMALL)
        middles = {
            y: median(found)
            for y, name in enumerate(names)
            if (found := values(at.get((name, planes[0]), ()), measure))
        }
        if middles:
            best = (max if MEASURES[measure].better == "high" else min)(middles.values())
            winners = [y for y in middles if abs(middles[y] - best) <= TIE * abs(best)]
            title = f"{message}\nbest: {_list_names([names[y] for y in reversed(winners)])}"
            panel.set_title(title, fontsize=SMALL)
            for y in winners:
                height = _height(y, 0, len(planes))
                panel.plot(
                    middles[y], height, "o", ms=10, mfc="none", mec="0.2", mew=1.0, clip_on=False
                )
        for k, plane in enumerate(planes):
            colour = CURVES[k % len(CURVES)]
            for y, name in enumerate(names):
                if found := values(at.get((name, plane), ()), measure):
                    height = _height(y, k, len(planes))
                    panel.plot(found, [height] * len(found), ".", color=colour, ms=3, alpha=0.25)
                    panel.plot(median(found), height, "|", color=colour, ms=6, mew=1.6)
        if not panel.lines:
            _note_empty(panel)
        _axis(panel, "x", measure)
        panel.grid(color="0.93", linewidth=0.5)
        panel.tick_params(labelsize=SMALL_FONT)
    for panel in grid[:, 0]:
        panel.set_yticks(range(len(names)), names, fontsize=SMALL_FONT)
    for k, plane in enumerate(planes):
        grid[0, 0].plot([], [], "|", color=CURVES[k % len(CURVES)], mew=2, label=plane)
    page.legend(loc="outside upper center", ncols=len(planes), fontsize=SMALL, frameon=False)
    save(page, path, 64)


def _list_names(names: Sequence[str]) -> str:
    """Return up to two names, or one and the number of the others."""
    if len(names) <= 2:
        return " and ".join(names)
    return f"{names[0]} and {len(names) - 1} others"


def _note_empty(panel: Panel) -> None:
    """Say in a panel that it has nothing to show."""
    place = {"transform": panel.transAxes, "ha": "center", "va": "center"}
    panel.text(0.5, 0.5, "no values", color="0.5", fontsize=SMALL, **place)


def _height(y: int, k: int, planes: int) -> float:
    """Return where the k-th plane of layout y is drawn."""
    return y + 0.7 * (0.5 - (k + 0.5) / planes)


def trends(rows: Sequence[Row], path: Path) -> None:
    """Draw measures against layout dimensions: a mark for the median of each layout in each plane."""
    at, shown = _group_rows(rows), list(MESSAGES)[:4]
    planes = list(dict.fromkeys(plane for _, plane in at))
    kinds = list(dict.fromkeys(found[0]["layout.type"] for found in at.values()))
    page = figure(2.0 + 2.2 * len(AGAINST), 0.6 + 1.5 * len(shown))
    grid = page.subplots(len(shown), len(AGAINST), squeeze=False, sharex="col", sharey="row")
    for (i, j), panel in np.ndenumerate(grid):
        for (_, plane), found in at.items():
            x, y = values(found, AGAINST[j]), values(found, shown[i])
            if x and y:
                colour = CURVES[planes.index(plane) % len(CURVES)]
                marker = MARKS[kinds.index(found[0]["layout.type"]) % len(MARKS)]
                panel.plot(median(x), median(y), marker, color=colour, ms=4, alpha=0.7)
        if not panel.lines:
            _note_empty(panel)
        if j == 0:
            _axis(panel, "y", shown[i])
        if i == len(shown) - 1:
            _axis(panel, "x", AGAINST[j])
        panel.grid(color="0.93", linewidth=0.5)
        panel.tick_params(labelsize=SMALL_FONT, which="both")
    for k, plane in enumerate(planes):
        grid[0, 0].plot([], [], "o", color=CURVES[k % len(CURVES)], label=plane)
    for k, kind in enumerate(kinds):
        grid[0, 0].plot([], [], MARKS[k % len(MARKS)], color="0.5", mfc="none", label=kind)
    page.legend(loc="outside right upper", fontsize=SMALL, frameon=False)
    save(page, path, 64)


def values(rows: Iterable[Row], measure: str) -> list[float]:
    """Return the finite values of a measure, in the unit that is drawn."""
    factor, _ = _unit(measure)
    found = (row[measure] for row in rows)
    return [factor * v for v in found if v is not None and np.isfinite(v)]


def format_measure(measure: str) -> str:
    """Return the name of a measure, with the unit that is drawn."""
    unit = _unit(measure)[1]
    return measure.replace("_", " ") + (f" [{unit}]" if unit else "")


def _group_rows(rows: Iterable[Row]) -> dict[tuple[str, str], list[Row]]:
    """Return the rows of each drawn layout and plane."""
    at: dict[tuple[str, str], list[Row]] = defaultdict(list)
    for row in rows:
        at[row["layout"], row["plane"]].append(row)
    names, planes = (list(dict.fromkeys(labels)) for labels in zip(*at, strict=True))
    kept = {(name, plane) for name in names[:LAYOUTS] for plane in planes[:PLANES]}
    return {where: at[where] for where in at if where in kept}


def _axis(panel: Panel, which: str, measure: str) -> None:
    """Label the axis "x" or "y" with a measure, and scale it."""
    from matplotlib.ticker import LogLocator, NullFormatter

    getattr(panel, f"set_{which}label")(format_measure(measure), fontsize=SMALL)
    axis = getattr(panel, f"{which}axis")
    if measure not in LOGARITHMIC or not np.isfinite(axis.get_minpos()):
        return
    getattr(panel, f"set_{which}scale")("log")
    low, high = axis.get_data_interval()
    if 0.0 < low <= high < 300.0 * low:
        parts = (1.0, 2.0, 5.0) if high > 3.0 * low else range(1, 10)
        axis.set_major_locator(LogLocator(subs=parts))
        axis.set_major_formatter(format_tick)
    axis.set_minor_formatter(NullFormatter())


def _unit(measure: str) -> tuple[float, str]:
    unit = MEASURES[measure].unit if measure in MEASURES else "m"
    if measure == "transducers":
        unit = ""
    return SCALES.get(unit, (1.0, unit))
