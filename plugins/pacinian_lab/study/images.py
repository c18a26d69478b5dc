"""Pictures of a study: its layouts, and the images that their arrays make."""

from __future__ import annotations

import textwrap
from typing import TYPE_CHECKING, Any

import numpy as np

from pacinian.plot.page import figure, save
from pacinian.plot.style import MAP, SMALL, TEXT, Panel
from pacinian_lab.study.worker import quantise_gains, solve

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence
    from pathlib import Path

    from pacinian.types import Floats
    from pacinian_lab.study.tasks import Plan, Task

ACROSS = 6  # panels per row
LAYOUTS, PLANES, PATTERNS = 48, 8, 4  # maximum numbers drawn
MARKED = 64  # maximum number of marked points
SMALL_FONT = 6.5  # [pt]


def layouts(plan: Plan, path: Path) -> None:
    """Draw the layouts from above, coloured by height."""
    entries = list({t.place.layout.label: t.place.layout for t in plan.tasks}.values())[:LAYOUTS]
    arrays = [plan.array(entry.value) for entry in entries]
    columns = min(ACROSS, len(arrays))
    rows = -(-len(arrays) // columns)
    page = figure(1.2 + 1.4 * columns, 0.4 + 1.7 * rows)
    page.set_layout_engine("compressed")
    panels = page.subplots(rows, columns, squeeze=False).ravel()
    corners = [f(array.positions, axis=0) for array in arrays for f in (np.min, np.max)]
    low, high = 1e3 * np.min(corners, axis=0), 1e3 * np.max(corners, axis=0)
    reach = float(np.abs([low[:2], high[:2]]).max()) + 10.0
    image: Any = None
    for panel, entry, array in zip(panels, entries, arrays, strict=False):
        x, y, z = 1e3 * array.positions.T
        image = panel.scatter(
            x, y, c=z, s=1.0, linewidths=0, cmap=MAP, vmin=low[2], vmax=max(high[2], low[2] + 1.0)
        )
        panel.set(xlim=(-reach, reach), ylim=(-reach, reach), aspect="equal")
        panel.set_title(f"{_wrap_label(entry.label)}\nN = {len(array)}", fontsize=SMALL)
        panel.tick_params(labelsize=SMALL_FONT)
        panel.locator_params(nbins=2)
    for panel in panels[len(arrays) :]:
        panel.set_axis_off()
    page.supxlabel("x [mm]", fontsize=SMALL)
    page.supylabel("y [mm]", fontsize=SMALL)
    if high[2] > low[2]:
        _bar(page, image, panels.tolist(), "height [mm]")
    save(page, path)


def images(plan: Plan, folder: Path, advance: Callable[[], object]) -> list[Path]:
    """Draw |p| of the first solver at the first level, a page for each plane and some layouts; return the files."""
    files: list[Path] = []
    for tasks in pages(plan):
        files.append(folder / f"images-{len(files) + 1}.png")
        _images(plan, tasks, files[-1], advance)
    return files


def pages(plan: Plan) -> Iterator[list[list[Task]]]:
    """Yield the tasks of each page of images: a row for each pattern, a column for each layout."""
    at: dict[tuple[str, str, str], Task] = {}
    for task in plan.tasks:
        place = task.place
        at.setdefault((place.plane.label, place.layout.label, place.pattern.label), task)
    planes, layouts, patterns = (list(dict.fromkeys(labels)) for labels in zip(*at, strict=True))
    for plane in planes[:PLANES]:
        for first in range(0, min(len(layouts), LAYOUTS), ACROSS):
            some = layouts[first : min(first + ACROSS, LAYOUTS)]
            yield [[at[plane, name, pattern] for name in some] for pattern in patterns[:PATTERNS]]


def _images(
    plan: Plan, tasks: Sequence[Sequence[Task]], path: Path, advance: Callable[[], object]
) -> None:
    page = figure(1.4 + 1.4 * len(tasks[0]), 1.0 + 1.3 * len(tasks))
    page.set_layout_engine("compressed")  # because all panels are square
    grid = page.subplots(len(tasks), len(tasks[0]), squeeze=False, sharex=True, sharey=True)
    half = 500.0 * plan.study.picture.side  # [mm]
    image = None
    for row, panels in zip(tasks, grid, strict=True):
        for task, panel in zip(row, panels, strict=True):
            panel.set(xlim=(-half, half), ylim=(-half, half), aspect="equal")
            panel.tick_params(labelsize=SMALL_FONT)
            panel.locator_params(nbins=2)
            try:
                field, points = _field(plan, task)
            except Exception as error:
                text = _wrap_label(str(error), 24)
                panel.text(0.0, 0.0, text, ha="center", va="center", fontsize=SMALL_FONT)
                continue
            finally:
                advance()
            most = float(np.nanmax(field, initial=0.0)) or 1.0
            image = panel.imshow(
                field / most, origin="lower", extent=(-half, half, -half, half), cmap=MAP, vmin=0.0,
                vmax=1.0,
            )  # fmt: skip
            if len(points) <= MARKED:
                panel.plot(*(1e3 * points.T), "o", mfc="none", mec="white", ms=2.4, mew=0.3)
            panel.set_title(f"maximum {1e-3 * most:.3g} kPa", fontsize=SMALL_FONT, pad=2)
        panels[0].set_ylabel(f"{_wrap_label(row[0].place.pattern.label)}\nv [mm]", fontsize=SMALL)
    for task, panel in zip(tasks[0], grid[0], strict=True):
        panel.set_title(
            f"{_wrap_label(task.place.layout.label)}\n{panel.get_title()}", fontsize=SMALL
        )
    for panel in grid[-1]:
        panel.set_xlabel("u [mm]", fontsize=SMALL)
    if image is not None:
        _bar(page, image, grid.ravel().tolist(), "|p| relative to its maximum")
    first = tasks[0][0]
    title = f"{first.place.plane.label}: {first.method.label}, level {first.level:g}"
    page.suptitle(title, fontsize=TEXT)
    save(page, path)


def _field(plan: Plan, task: Task) -> tuple[Floats, Floats]:
    """Return |p| [Pa] in the picture, and the points with a target in its plane [m]."""
    batch = plan.batch([task])
    target_plane = batch.target_plane()
    gains = quantise_gains(batch, solve(batch, target_plane, batch.jobs[0]).gains)
    return target_plane.field(gains), target_plane.uv[target_plane.asked]


def _bar(page: Any, image: Any, panels: Sequence[Panel], label: str) -> None:
    """Draw one colour scale for all panels."""
    made = page.colorbar(image, ax=panels, shrink=0.7)
    made.set_label(label, fontsize=SMALL)
    made.ax.tick_params(labelsize=SMALL_FONT)


def _wrap_label(label: str, width: int = 18) -> str:
    """Return a label, wrapped to several lines."""
    return "\n".join(textwrap.wrap(label, width))
