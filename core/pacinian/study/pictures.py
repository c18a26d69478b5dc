"""Pictures of a study: its layouts, and what was measured of them."""

from __future__ import annotations

from statistics import median
from typing import TYPE_CHECKING, Any

import numpy as np

from pacinian.plot.page import figure, save
from pacinian.plot.style import CURVES, MAP, MARKS, SMALL, Panel
from pacinian.study.images import firsts, wrapped
from pacinian.study.measures import MEASURES

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from pacinian.study.measuring import Row
    from pacinian.study.tasks import Plan

ACROSS = 6  # panels beside each other
TINY = 6.5  # [pt]
SHOWN = (
    "width_across_x",
    "width_along",
    "efficiency",
    "side_lobe",
    "contrast",
    "yield",
    "shape_error",
)
AGAINST = ("aperture", "spacing", "transducers")
SCALES = {"m": (1e3, "mm"), "Pa": (1e-3, "kPa")}  # of the units that are drawn otherwise
LOGARITHMIC = ("yield", "shape_error", "width_along", "width_across_x", *AGAINST)


def layouts(plan: Plan, path: Path) -> None:
    """Every layout from above; a colour is a height."""
    places = firsts(plan, lambda place: place.layout.label)
    columns = min(ACROSS, len(places))
    rows = -(-len(places) // columns)
    page = figure(0.6 + 2.1 * columns, 0.5 + 2.3 * rows)
    panels = page.subplots(rows, columns, squeeze=False).ravel()
    arrays = [plan.array(task.place.layout.value) for task in places]
    reach = 1e3 * max(float(np.abs(array.positions[:, :2]).max()) for array in arrays) + 10.0
    tops = [float(np.abs(array.positions[:, 2]).max()) for array in arrays]
    image: Any = None
    for panel, task, array in zip(panels, places, arrays, strict=False):
        x, y, z = 1e3 * array.positions.T
        image = panel.scatter(x, y, c=z, s=2.0, cmap=MAP, vmin=0.0, vmax=max(1.0, 1e3 * max(tops)))
        panel.set(xlim=(-reach, reach), ylim=(-reach, reach), aspect="equal")
        panel.set_title(f"{wrapped(task.place.layout.label)}\nN = {len(array)}", fontsize=SMALL)
        panel.tick_params(labelsize=TINY)
    for panel in panels[len(places) :]:
        panel.set_axis_off()
    page.supxlabel("x [mm]", fontsize=SMALL)
    page.supylabel("y [mm]", fontsize=SMALL)
    if max(tops) > 0.0:
        page.colorbar(image, ax=panels.tolist(), label="height [mm]", shrink=0.6)
    save(page, path)


def measures(rows: Sequence[Row], path: Path) -> None:
    """Each measure of each layout: a dot for every task, a mark at the median, a colour for each plane."""
    names = list(dict.fromkeys(row["layout"] for row in rows))[::-1]
    planes = list(dict.fromkeys(row["plane"] for row in rows))
    page = figure(2.5 + 1.9 * len(SHOWN), 1.2 + 0.26 * len(names) + 0.1 * len(planes))
    panels = page.subplots(1, len(SHOWN), sharey=True, squeeze=False)[0]
    for panel, measure in zip(panels, SHOWN, strict=True):
        for k, plane in enumerate(planes):
            for y, name in enumerate(names):
                found = values(rows, measure, layout=name, plane=plane)
                if not found:
                    continue
                height = y + 0.5 * ((k + 0.5) / len(planes) - 0.5)
                colour = CURVES[k % len(CURVES)]
                panel.plot(found, [height] * len(found), ".", color=colour, ms=3, alpha=0.4)
                panel.plot(median(found), height, "|", color=colour, ms=8, mew=2)
        _axis(panel, "x", measure)
        panel.grid(color="0.93", linewidth=0.5)
        panel.tick_params(labelsize=TINY)
    panels[0].set_yticks(range(len(names)), names, fontsize=SMALL)
    for k, plane in enumerate(planes):
        panels[-1].plot([], [], "|", color=CURVES[k % len(CURVES)], mew=2, label=plane)
    page.legend(loc="outside upper center", ncols=len(planes), fontsize=SMALL, frameon=False)
    save(page, path, 64)


def trends(rows: Sequence[Row], path: Path) -> None:
    """Measures against what layouts have in numbers: a mark for the median of each layout in each plane."""
    shown = SHOWN[:4]
    kinds = list(dict.fromkeys(row["layout.type"] for row in rows))
    planes = list(dict.fromkeys(row["plane"] for row in rows))
    names = list(dict.fromkeys(row["layout"] for row in rows))
    page = figure(2.0 + 2.2 * len(AGAINST), 0.6 + 1.5 * len(shown))
    grid = page.subplots(len(shown), len(AGAINST), squeeze=False, sharex="col", sharey="row")
    for (i, j), panel in np.ndenumerate(grid):
        measure, against = shown[i], AGAINST[j]
        for name in names:
            for k, plane in enumerate(planes):
                y = values(rows, measure, layout=name, plane=plane)
                x = values(rows, against, layout=name, plane=plane)
                if not (x and y):
                    continue
                kind = next(row["layout.type"] for row in rows if row["layout"] == name)
                marker = MARKS[kinds.index(kind) % len(MARKS)]
                panel.plot(
                    median(x), median(y), marker, color=CURVES[k % len(CURVES)], ms=4, alpha=0.7
                )
        if j == 0:
            _axis(panel, "y", measure)
        if i == len(shown) - 1:
            _axis(panel, "x", against)
        panel.grid(color="0.93", linewidth=0.5)
        panel.tick_params(labelsize=TINY, which="both")
    for k, plane in enumerate(planes):
        grid[0, 0].plot([], [], "o", color=CURVES[k % len(CURVES)], label=plane)
    for k, kind in enumerate(kinds):
        grid[0, 0].plot([], [], MARKS[k % len(MARKS)], color="0.5", mfc="none", label=kind)
    page.legend(loc="outside right upper", fontsize=SMALL, frameon=False)
    save(page, path, 64)


def values(rows: Sequence[Row], measure: str, **where: str) -> list[float]:
    """A measure where it is finite, in the unit that is drawn."""
    factor, _ = _unit(measure)
    found = [row[measure] for row in rows if all(row[k] == v for k, v in where.items())]
    return [factor * v for v in found if v is not None and np.isfinite(v)]


def _axis(panel: Panel, which: str, measure: str) -> None:
    """Label the axis "x" or "y" with a measure, and scale it."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    unit = _unit(measure)[1]
    text = measure.replace("_", " ") + (f" [{unit}]" if unit else "")
    getattr(panel, f"set_{which}label")(text, fontsize=SMALL)
    axis = getattr(panel, f"{which}axis")
    if measure not in LOGARITHMIC or not np.isfinite(axis.get_minpos()):
        return
    getattr(panel, f"set_{which}scale")("log")
    low, high = axis.get_data_interval()
    if 0.0 < low <= high < 50.0 * low:
        parts = (1.0, 2.0, 5.0) if high > 3.0 * low else range(1, 10)
        axis.set_major_locator(LogLocator(subs=parts))
        axis.set_major_formatter(FuncFormatter(_plainly))
    axis.set_minor_formatter(NullFormatter())


def _plainly(value: float, place: int) -> str:
    """A tick without powers of ten."""
    return f"{value:g}"


def _unit(measure: str) -> tuple[float, str]:
    unit = MEASURES[measure].unit if measure in MEASURES else "m"
    if measure == "transducers":
        unit = ""
    return SCALES.get(unit, (1.0, unit))
