"""Pictures. Needs Matplotlib: `pip install "pacinian[plot]"`; works without a display."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from pacinian.acoustics.air import Air
from pacinian.acoustics.pressure import radiation_pressure
from pacinian.acoustics.propagation import field
from pacinian.errors import MissingExtra

if TYPE_CHECKING:
    from pathlib import Path

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from pacinian.acoustics.array import Array
    from pacinian.types import Floats, Gains

GRID = 240  # points along an edge of a slice
MAP = "viridis"


def figure(width: float, height: float) -> Figure:
    """An empty figure, width x height [inch]. Raises MissingExtra."""
    try:
        from matplotlib.figure import Figure
    except ImportError as error:
        raise MissingExtra("matplotlib", "plot") from error
    return Figure(figsize=(width, height), layout="constrained")


def slices(
    array: Array, gains: Gains, points: Floats, medium: Air | None = None, title: str = ""
) -> Figure:
    """Radiation pressure on skin in the two planes through the points that tell most.

    A horizontal slice at the points' mean height and a vertical one through the strongest of them.
    array, gains: (N,). points: what is to be felt [m], (M, 3). Raises MissingExtra.
    """
    medium = medium or Air()
    middle = points.mean(axis=0) if len(points) else array.centre + np.array([0.0, 0.0, 0.2])
    reach = 0.03 + (np.abs(points - middle).max() if len(points) else 0.05)  # [m]
    u = np.linspace(-reach, reach, GRID)
    y = (
        points[np.argmax(np.abs(field(array, gains, points, medium))), 1]
        if len(points)
        else middle[1]
    )
    top = middle[2] + reach
    z = np.linspace(min(0.005 + array.positions[:, 2].max(), middle[2] - reach), top, GRID)
    narrow = 2.0 * reach / (z[-1] - z[0])  # of the vertical slice, beside a square
    page = figure(1.6 + 4.4 * (1.0 + narrow), 4.8)
    left, right = page.subplots(1, 2, width_ratios=[1.0, narrow])
    X, Y = np.meshgrid(middle[0] + u, middle[1] + u)
    across = np.stack([X, Y, np.full_like(X, middle[2])], axis=-1)
    X, Z = np.meshgrid(middle[0] + u, z)
    along = np.stack([X, np.full_like(X, y), Z], axis=-1)
    P = [
        radiation_pressure(field(array, gains, plane, medium), medium) for plane in (across, along)
    ]
    most = max(float(part.max()) for part in P) or 1.0
    for axes, part, (i, j), plane in ((left, P[0], (0, 1), across), (right, P[1], (0, 2), along)):
        extent = [1e3 * plane[..., k].flat[n] for k in (i, j) for n in (0, -1)]
        image = axes.imshow(
            part, origin="lower", extent=tuple(extent), cmap=MAP, vmin=0.0, vmax=most
        )
        axes.set(xlabel=f"{'xyz'[i]} [mm]", ylabel=f"{'xyz'[j]} [mm]")
        _mark(axes, 1e3 * points[:, [i, j]])
    left.set_title(f"z = {1e3 * middle[2]:.0f} mm")
    right.set_title(f"y = {1e3 * y:.0f} mm")
    page.colorbar(image, ax=[left, right], label="radiation pressure on skin [Pa]")
    if title:
        page.suptitle(title)
    return page


def save(page: Figure, path: str | Path) -> None:
    """Write a figure to a file (PNG by its name)."""
    page.savefig(path, dpi=130)


def _mark(axes: Axes, at: Floats) -> None:
    if len(at):
        axes.plot(at[:, 0], at[:, 1], "o", mfc="none", mec="white", ms=5, mew=0.8, label="samples")
        axes.legend(loc="upper right", framealpha=0.5)
