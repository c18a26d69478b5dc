"""Draws docs/pictures/autd3-emulator.png and says what is in docs/autd3.md: python -m tests.devices.autd3.picture."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from pacinian import plot
from pacinian.plot.page import figure
from pacinian.plot.style import MAP, bar, dress

from .fields import GRIDS, HALF, POINTS, SOURCES, compared

FILE = Path(__file__).parents[3] / "docs" / "pictures" / "autd3-emulator.png"
HEAD = (
    "array", "points", "transducers", "field, of what was sent", "field, of the gains", "at the points",
)  # fmt: skip


def table() -> str:
    """Errors in percent."""
    rows = [HEAD, ("---",) * len(HEAD)]
    for source in SOURCES:
        for grid in GRIDS:
            for points in POINTS:
                it = compared(grid, points, source)
                errors = (f"{100.0 * error:.2g}" for error in (it.sent, it.rounded, it.points))
                rows.append((grid, points, source, *errors))
    return "\n".join(f"| {' | '.join(row)} |" for row in rows)


def draw() -> None:
    """The emulator's field, ours, and the difference."""
    page = figure(7.2, 4.6)
    extent = tuple(1e3 * one for one in (-HALF, HALF, -HALF, HALF))
    for row, points in zip(page.subplots(2, 3), POINTS, strict=True):
        it = compared("nine units", points, "omni", 0.5e-3)
        side = round(len(it.places) ** 0.5)
        order = np.lexsort((it.places[:, 0], it.places[:, 1]))
        theirs, ours = (p[order].reshape(side, side) for p in (it.theirs, it.ours))
        off = 1e6 * (ours - theirs) / theirs.max()
        top = float(np.abs(off).max())
        for panel, title, values, colours, limits in (
            (row[0], "AUTD3 emulator", 1e-3 * theirs, MAP, (0.0, 1e-3 * theirs.max())),
            (row[1], "Pacinian", 1e-3 * ours, MAP, (0.0, 1e-3 * theirs.max())),
            (row[2], "difference", off, "RdBu_r", (-top, top)),
        ):
            image = panel.imshow(
                values, colours, origin="lower", extent=extent,
                vmin=limits[0], vmax=limits[1],
            )  # fmt: skip
            panel.set(title=f"{points}: {title}", xlabel="x [mm]")
            bar(page, image, panel, "millionths of the largest" if values is off else "[kPa]")
        row[0].set_ylabel("y [mm]")
    plot.save(dress(page), FILE, colours=200)


if __name__ == "__main__":
    import sys

    draw()
    sys.stdout.write(table() + "\n")
