"""The field in two planes: radiation pressure across and along the way of the sound."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from pacinian.acoustics.air import Air
from pacinian.acoustics.pressure import radiation_pressure
from pacinian.acoustics.propagation import field
from pacinian.plot.page import figure

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.figure import Figure

    from pacinian.acoustics.array import Array
    from pacinian.types import Floats, Gains

Panel = Any  # Matplotlib's axes: its stubs leave too much open

GRID = 240  # points along an edge of a slice
MAP = "viridis"
MARGIN, ALONE = 0.03, 0.08  # [m] around the samples, and where there are none
BESIDE = 0.012  # [m] from the vertical plane: only samples so near are marked in it
AHEAD = 0.2  # [m] before the array: looked at where there is no sample


@dataclass(frozen=True, eq=False)
class Plane:
    """The field in a plane, or its mean over several moments.

    points: (GRID, GRID, 3) [m]. pressure: radiation pressure on skin, (GRID, GRID) [Pa]. axes: which of x,
    y, z runs to the right and which up; height: of the third [m].
    """

    points: Floats
    pressure: Floats
    axes: tuple[int, int]
    height: float

    @property
    def sides(self) -> Floats:
        """Left, right, bottom and top [m]."""
        i, j = self.axes
        first, last = self.points[0, 0], self.points[-1, -1]
        return np.array([first[i], last[i], first[j], last[j]])


def planes(array: Array, gains: Gains, points: Floats, medium: Air) -> tuple[Plane, Plane]:
    """A horizontal plane at the points' mean height, and a vertical one through the strongest of them.

    gains: (N,), or (K, N) for the mean over K moments. points: what is to be felt [m], (M, 3).
    """
    rows = np.atleast_2d(gains)

    def pressure(at: Floats) -> Floats:
        parts = [radiation_pressure(field(array, g, at, medium), medium) for g in rows]
        return np.asarray(np.mean(parts, axis=0))

    middle, reach = middle_of(array, points), ALONE
    y = middle[1]
    if len(points):
        reach = MARGIN + float(np.abs(points - middle).max())  # [m]
        y = points[pressure(points).argmax(), 1]
    u = np.linspace(-reach, reach, GRID)
    bottom = min(0.005 + array.positions[:, 2].max(), middle[2] - reach)
    z = np.linspace(bottom, middle[2] + reach, GRID)
    X, Y = np.meshgrid(middle[0] + u, middle[1] + u)
    across = np.stack([X, Y, np.full_like(X, middle[2])], axis=-1)
    X, Z = np.meshgrid(middle[0] + u, z)
    along = np.stack([X, np.full_like(X, y), Z], axis=-1)
    return (
        Plane(across, pressure(across), (0, 1), float(middle[2])),
        Plane(along, pressure(along), (0, 2), float(y)),
    )


def middle_of(array: Array, points: Floats) -> Floats:
    """The middle of what is looked at, (3,) [m]: of points, (M, 3), if there are any."""
    if len(points):
        return np.asarray(points.mean(axis=0))
    return np.asarray(array.centre + np.array([0.0, 0.0, AHEAD]))


def slices(
    array: Array, gains: Gains, points: Floats, medium: Air | None = None, title: str = ""
) -> Figure:
    """Radiation pressure on skin in the two planes through the points that tell most.

    A horizontal slice at the points' mean height and a vertical one through the strongest of them.
    array, gains: (N,), or (K, N) for the mean over K moments. points: what is to be felt [m], (M, 3).
    Raises MissingExtra.
    """
    cuts = planes(array, gains, points, medium or Air())
    narrow = ratio(cuts)
    page = figure(1.6 + 4.4 * (1.0 + narrow), 4.8)
    show(page, page.subplots(1, 2, width_ratios=[1.0, narrow]), cuts, points)
    if title:
        page.suptitle(title)
    return page


def ratio(cuts: Sequence[Plane]) -> float:
    """Width of the vertical one over that of the horizontal one, where both are equally high."""
    left, right, bottom, top = cuts[1].sides
    return float((right - left) / (top - bottom))


def show(page: Any, panels: Sequence[Panel], cuts: Sequence[Plane], points: Floats) -> None:
    """Draw planes into panels, with one scale of colours, and mark the points, (M, 3) [m]."""
    most = max(float(cut.pressure.max()) for cut in cuts) or 1.0
    image = None
    for panel, cut in zip(panels, cuts, strict=True):
        i, j = cut.axes
        image = panel.imshow(
            cut.pressure, origin="lower", extent=tuple(1e3 * cut.sides), cmap=MAP, vmin=0.0,
            vmax=most,
        )  # fmt: skip
        panel.set(xlabel=f"{'xyz'[i]} [mm]", ylabel=f"{'xyz'[j]} [mm]")
        panel.set_title(f"{'xyz'[3 - i - j]} = {1e3 * cut.height:.0f} mm")
        near = np.abs(points[:, 1] - cut.height) < BESIDE if j == 2 else np.ones(len(points), bool)
        x, y = 1e3 * points[near][:, [i, j]].T
        panel.plot(x, y, "o", mfc="none", mec="white", ms=5, mew=0.8, label="samples")
    if len(points):
        panels[0].legend(loc="upper right", framealpha=0.5)
    page.colorbar(image, ax=list(panels), label="radiation pressure on skin [Pa]")
