"""Pictures of each shape: the request, the pressures of regions and of foci, and the errors. Needs Matplotlib."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

import numpy as np

from pacinian.plot import figure, save
from pacinian.plot.style import BLUE, GREY, LINE, MAP, RED, SMALL, bar, dress
from pacinian_lab.regions.methods import FREE, OURS
from pacinian_lab.regions.run import find_strongest, judge, make
from pacinian_lab.regions.score import evaluate_pressure
from pacinian_lab.regions.shapes import SHAPES

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

    from matplotlib.figure import Figure

    from pacinian.acoustics.array import Array
    from pacinian.plot.style import Panel
    from pacinian.types import Floats
    from pacinian_lab.regions.run import Row
    from pacinian_lab.regions.shapes import View

STRENGTH = 0.5  # fraction of the strongest even field
FOCI = next(iter(FREE))
TOP = 1.5  # end of the pressure scale, relative to the request
LEGEND = 2.6  # end of the axis of a cut, relative to the request: it leaves room for the legend
DIFFERENCES = "RdBu_r"
COLOURS = 256
FRONT = "letter H", "disc, 30 mm"  # shapes of the overview
OVERVIEW = "regions.png"
WIDE = 2.0  # width over height above which panels are stacked


def draw(array: Array, names: Sequence[str], folder: Path) -> Iterator[Path]:
    """Draw shapes as PNG files in `folder`, then an overview if its shapes are among them. Raises MissingExtra."""
    pictures = dict[str, Picture]()
    for name in names:
        picture = Picture(array, name)
        if name in FRONT:
            pictures[name] = picture
        path = folder / f"regions-{_slug(name)}.png"
        save(picture.draw(), path, COLOURS)
        yield path
    if len(pictures) == len(FRONT):
        save(draw_overview([pictures[name] for name in FRONT]), folder / OVERVIEW, COLOURS)
        yield folder / OVERVIEW


class Picture:
    """Pressures of one shape in its view, made by regions and by free-phase foci 8.5 mm apart."""

    def __init__(self, array: Array, name: str) -> None:
        shape = SHAPES[name]()
        self.name, self.view = name, shape.view
        self.pressure = STRENGTH * find_strongest(array, shape)
        """Maximum of the request [Pa]."""
        self.asked = self.pressure * shape.view.asked
        self.made: dict[str, tuple[Row, Floats]] = {}
        """By way: the figures, and the pressure in the view, (R, C) [Pa]."""
        for way in (OURS, FOCI):
            made = make(array, shape, way, self.pressure)
            row = judge(array, shape, made, (name, way, STRENGTH, self.pressure))
            self.made[way] = row, evaluate_pressure(array, made.gains, shape.view.points)

    def draw(self) -> Figure:
        """Draw request, result and error, with regions above foci, and a cut through the middle."""
        left, right, bottom, top = self.view.sides
        ratio = (right - left) / (top - bottom)
        stacked = ratio > WIDE
        rows = list(self.made.items())
        if stacked:
            page = figure(7.0, 6.6)
            cells = page.subplots(3, 2)
            asked, cut = cells[0]
            both = [(cells[1, 0], cells[1, 1]), (cells[2, 0], cells[2, 1])]
        else:
            page = figure(7.4, 5.8)
            cells = page.subplots(2, 3)
            asked, cut = cells[0, 0], cells[1, 0]
            both = [(cells[0, 1], cells[0, 2]), (cells[1, 1], cells[1, 2])]
        image, difference = None, None
        self.paint(asked, self.asked, f"requested: {self.pressure:.2g} Pa")
        for (way, (row, made)), (achieved, missed) in zip(rows, both, strict=True):
            image = self.paint(achieved, made, f"{way}\n{describe(row)}")
            difference = self.paint(missed, made - self.asked, "difference", signed=True)
        self.cut(cut)
        bar(page, image, [achieved for achieved, _ in both], "radiation pressure [Pa]", below=True)
        bar(page, difference, [missed for _, missed in both], "difference [Pa]", below=True)
        page.suptitle(self.name + (f" ({self.view.title})" if self.view.title else ""))
        return dress(page)

    def paint(self, panel: Panel, found: Floats, title: str, *, signed: bool = False) -> Any:
        """Draw values (R, C) [Pa] of the view with the outline of the shape. Returns the image."""
        sides = tuple(1e3 * side for side in self.view.sides)
        low, high = (-self.pressure, self.pressure) if signed else (0.0, TOP * self.pressure)
        image = panel.imshow(
            found, origin="lower", extent=sides, vmin=low, vmax=high,
            cmap=DIFFERENCES if signed else MAP, interpolation_stage="data",
        )  # fmt: skip
        if self.asked.min() < self.asked.max():
            outline(panel, self.view, "0.2" if signed else "white")
        panel.set(xlabel=self.view.labels[0], ylabel=self.view.labels[1], title=title)
        return image

    def cut(self, panel: Panel) -> None:
        """Draw the pressures along the middle row of the view."""
        left, right = self.view.sides[:2]
        middle = len(self.asked) // 2
        x = 1e3 * np.linspace(left, right, self.asked.shape[1])
        panel.plot(x, self.asked[middle], color=GREY, linewidth=2.0 * LINE, label="requested")
        for (way, (_, made)), colour in zip(self.made.items(), (BLUE, RED), strict=True):
            panel.plot(x, made[middle], color=colour, linewidth=LINE, label=way)
        panel.set(
            xlabel=self.view.labels[0], ylabel="pressure [Pa]", title="along the middle",
            xlim=(x[0], x[-1]), ylim=(0.0, LEGEND * self.pressure),
        )  # fmt: skip
        panel.legend(loc="upper center", frameon=False, fontsize=SMALL)


def draw_overview(pictures: Sequence[Picture]) -> Figure:
    """Draw request, foci and regions side by side, with a row for each shape."""
    page = figure(7.0, 0.8 + 2.3 * len(pictures))
    cells = page.subplots(len(pictures), 3, squeeze=False)
    for picture, row in zip(pictures, cells, strict=True):
        picture.paint(row[0], picture.asked, f"requested: {picture.pressure:.2g} Pa")
        image = None
        for panel, way in zip(row[1:], (FOCI, OURS), strict=True):
            found, made = picture.made[way]
            image = picture.paint(panel, made, f"{way}\n{describe(found)}")
        for panel in row[1:]:
            panel.set_ylabel("")
        bar(page, image, row[2], "radiation pressure [Pa]")
    return dress(page)


def describe(row: Row) -> str:
    """Return the figures of a row as a line of text."""
    return f"force {row.force:.0%}, rms {row.rms:.0%}, holes {row.holes:.0%}".replace("%", " %")


def outline(panel: Panel, view: View, colour: str) -> None:
    """Draw the outline of the request."""
    left, right, bottom, top = (1e3 * side for side in view.sides)
    x = np.linspace(left, right, view.asked.shape[1])
    y = np.linspace(bottom, top, view.asked.shape[0])
    panel.contour(x, y, view.asked > 0.0, [0.5], colors=colour, linewidths=0.6, linestyles="--")


def _slug(name: str) -> str:
    """Return a name for a file."""
    return re.sub(r"[^a-z0-9]+", "-", name.lower()).strip("-")
