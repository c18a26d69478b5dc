"""The images that a study's arrays make."""

from __future__ import annotations

import textwrap
from typing import TYPE_CHECKING, Any

import numpy as np

from pacinian.plot.page import figure, save
from pacinian.plot.style import MAP, SMALL
from pacinian.study.measuring import emitted, solve

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from pathlib import Path

    from pacinian.study.tasks import Place, Plan, Task
    from pacinian.types import Floats

ACROSS, DOWN = 6, 4  # panels of a page
MARKED = 64  # points at most that are marked
TINY = 6.5  # [pt]


def images(plan: Plan, folder: Path, advance: Callable[[], object]) -> list[Path]:
    """|p| of the first solver at the first level, in every place: a page for each plane and some layouts."""
    places = firsts(plan, lambda place: place)
    planes = labels(places, lambda place: place.plane.label)
    names = labels(places, lambda place: place.layout.label)
    patterns = labels(places, lambda place: place.pattern.label)[:DOWN]
    at = {(t.place.layout.label, t.place.plane.label, t.place.pattern.label): t for t in places}
    files: list[Path] = []
    for plane in planes:
        for first in range(0, len(names), ACROSS):
            shown = names[first : first + ACROSS]
            tasks = [[at[name, plane, pattern] for name in shown] for pattern in patterns]
            files.append(folder / f"images-{len(files) + 1}.png")
            _images(plan, tasks, plane, files[-1], advance)
    return files


def pages(plan: Plan) -> int:
    """How many images there are to be drawn."""
    places = firsts(plan, lambda place: place)
    patterns = labels(places, lambda place: place.pattern.label)
    return len(places) * min(DOWN, len(patterns)) // len(patterns)


def _images(
    plan: Plan,
    tasks: Sequence[Sequence[Task]],
    plane: str,
    path: Path,
    advance: Callable[[], object],
) -> None:
    page = figure(1.2 + 1.9 * len(tasks[0]), 0.9 + 2.0 * len(tasks))
    grid = page.subplots(len(tasks), len(tasks[0]), squeeze=False, sharex=True, sharey=True)
    half = 500.0 * plan.study.picture.side  # [mm]
    image = None
    for row, panels in zip(tasks, grid, strict=True):
        for task, panel in zip(row, panels, strict=True):
            try:
                field, points = _field(plan, task)
            except Exception as error:
                panel.text(
                    0.0, 0.0, wrapped(str(error), 24), ha="center", va="center", fontsize=TINY
                )
                panel.set(xlim=(-half, half), ylim=(-half, half))
                continue
            finally:
                advance()
            most = float(np.nanmax(field, initial=0.0)) or 1.0
            image = panel.imshow(
                field / most, origin="lower", extent=(-half, half, -half, half), cmap=MAP, vmin=0.0,
                vmax=1.0,
            )  # fmt: skip
            if len(points) <= MARKED:
                panel.plot(*(1e3 * points.T), "o", mfc="none", mec="white", ms=3, mew=0.4)
            panel.set_title(f"largest {1e-3 * most:.3g} kPa", fontsize=TINY, pad=2)
            panel.tick_params(labelsize=TINY)
        panels[0].set_ylabel(f"{wrapped(row[0].place.pattern.label)}\nv [mm]", fontsize=SMALL)
    for task, panel in zip(tasks[0], grid[0], strict=True):
        panel.set_title(f"{wrapped(task.place.layout.label)}\n{panel.get_title()}", fontsize=SMALL)
    for panel in grid[-1]:
        panel.set_xlabel("u [mm]", fontsize=SMALL)
    if image is not None:
        page.colorbar(image, ax=grid.ravel().tolist(), label="|p| over its largest", shrink=0.7)
    first = tasks[0][0]
    page.suptitle(f"{plane}: {first.method.label}, level {first.level:g}", fontsize=10)
    save(page, path)


def _field(plan: Plan, task: Task) -> tuple[Floats, Floats]:
    """|p| [Pa] in the picture, and the points asked in its plane [m]."""
    batch = plan.batch([task])
    stage = batch.stage()
    gains = emitted(batch, solve(batch, stage, batch.jobs[0]).gains)
    return stage.field(gains), stage.uv[stage.asked]


def wrapped(label: str, width: int = 22) -> str:
    """A label on as many lines as it needs."""
    return "\n".join(textwrap.wrap(label, width))


def firsts(plan: Plan, key: Callable[[Place], Any]) -> list[Task]:
    """The first task of each place, or of whatever else of it."""
    found: dict[Any, Task] = {}
    for task in plan.tasks:
        found.setdefault(key(task.place), task)
    return list(found.values())


def labels(tasks: Sequence[Task], label: Callable[[Place], str]) -> list[str]:
    """Different labels, in order."""
    return list(dict.fromkeys(label(task.place) for task in tasks))
