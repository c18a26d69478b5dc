"""Planes through a field: chooses and draws them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from pacinian.acoustics.pose import Pose
from pacinian.argument_checks import check_length, check_near, check_numbers
from pacinian.errors import ArgumentError
from pacinian.plot.quantities import QUANTITIES

if TYPE_CHECKING:
    from pacinian.acoustics.array import Array
    from pacinian.plot.style import Panel
    from pacinian.types import ArrayLike, Flags, Floats

GRID = 240  # points along the longer edge
MARGIN, HALF_WIDTH = 0.03, 0.08  # margin around samples; the same without samples [m]
MAX_PLANE_DISTANCE = 0.012  # distance up to which samples are marked in a plane [m]
MAX_CIRCLES = 24  # samples up to which circles mark them; more are dots, which hide less
AHEAD = 0.2  # distance in front of the array of what is drawn if there are no samples [m]
BEFORE = 0.005  # distance in front of the array at which a plane along the sound begins [m]
AXES = {"xy": (0, 1), "xz": (0, 2), "yz": (1, 2)}


@dataclass(frozen=True, eq=False)
class Plane:
    """A rectangle in space.

    points: (rows, columns, 3) [m]. u, v: coordinates along its columns and rows [m]. axes: which of x, y,
    z run to the right and up; None where a pose says where it is. height: of the third [m].
    """

    points: Floats
    u: Floats
    v: Floats
    axes: tuple[int, int] | None = None
    height: float = 0.0

    @property
    def sides(self) -> tuple[float, float, float, float]:
        """Left, right, bottom and top edge [m], half a step beyond the outer points."""
        ends: list[float] = []
        for along in (self.u, self.v):
            half = (along[1] - along[0]) / 2.0
            ends += [float(along[0] - half), float(along[-1] + half)]
        return ends[0], ends[1], ends[2], ends[3]

    @property
    def ratio(self) -> float:
        """Width over height."""
        left, right, bottom, top = self.sides
        return (right - left) / (top - bottom)

    @property
    def labels(self) -> tuple[str, str]:
        """Labels of its axes."""
        names = ("u", "v") if self.axes is None else ("xyz"[self.axes[0]], "xyz"[self.axes[1]])
        return f"{names[0]} [mm]", f"{names[1]} [mm]"

    @property
    def place(self) -> str:
        """Position of the plane as text, if one number describes it."""
        if self.axes is None:
            return ""
        height = round(1e3 * self.height, 1) + 0.0  # not -0
        return f"{'xyz'[3 - sum(self.axes)]} = {height:g} mm"

    def project(self, points: Floats) -> tuple[Floats, Flags]:
        """Return the in-plane coordinates of points (M, 3) [m], (M, 2) [m], and whether each is close to the plane."""
        corner, right, up = self.points[0, 0], self.points[0, -1], self.points[-1, 0]
        x, y = (
            (right - corner) / np.linalg.norm(right - corner),
            (up - corner) / np.linalg.norm(up - corner),
        )
        away = points - corner
        near = np.abs(away @ np.cross(x, y)) < MAX_PLANE_DISTANCE
        return np.stack([self.u[0] + away @ x, self.v[0] + away @ y], axis=-1), near


def middle_of(array: Array, points: Floats) -> Floats:
    """Return the centre of the view, (3,) [m]: the middle of the points, (M, 3), if there are any."""
    if len(points):
        return np.asarray(points.mean(axis=0))
    return np.asarray(array.centre + AHEAD * _compute_direction(array))


def cut(
    array: Array,
    through: str | Pose,
    at: ArrayLike | None,
    points: Floats,
    size: float | tuple[float, float] | None,
) -> Plane:
    """Return the plane "xy", "xz" or "yz" through a point [m], or the xy-plane of a pose.

    at: (3,); default: middle of the points, (M, 3) [m]. size: of a square, or width and height [m]; by default large
    enough for the points, and for "xz" and "yz" above an array, for the space down to the array.
    Raises ArgumentError.
    """
    check_near("points", points, array.centre)
    if isinstance(through, Pose):
        if at is not None:
            raise ArgumentError("at", "must be left out: the pose says where the plane is")
        half = _half(size, (points - through.position) @ through.matrix[:, :2])
        u, v = _steps(-half, half)
        U, V = np.meshgrid(u, v)
        return Plane(through.points(np.stack([U, V, 0.0 * U], axis=-1)), u, v)
    if through not in (*AXES,):
        raise ArgumentError("plane", f'must be "xy", "xz", "yz" or a Pose, not {through!r}')
    i, j = AXES[through]
    middle = middle_of(array, points) if at is None else check_numbers("at", at, (3,))
    check_near("at", middle[None], array.centre)
    half = _half(size, (points - middle)[:, [i, j]])
    low, high = middle[[i, j]] - half, middle[[i, j]] + half
    if size is None and j == 2:
        low[1] = min(low[1], max(array.positions[:, 2].max() + BEFORE, low[1] - 2.0 * AHEAD))
    u, v = _steps(low, high)
    U, V = np.meshgrid(u, v)
    where = np.empty((*U.shape, 3))
    where[..., i], where[..., j], where[..., 3 - i - j] = U, V, middle[3 - i - j]
    return Plane(where, u, v, (i, j), float(middle[3 - i - j]))


def draw(panel: Panel, plane: Plane, found: Floats, show: str, ends: tuple[float, float]) -> Any:
    """Draw the values of a plane, (rows, columns), into axes; return the image."""
    image = panel.imshow(
        np.maximum(found, ends[0]), origin="lower", extent=tuple(1e3 * side for side in plane.sides),
        cmap=QUANTITIES[show].colours, vmin=ends[0], vmax=ends[1],
        interpolation="nearest" if show == "phase" else None, interpolation_stage="data",
    )  # fmt: skip
    panel.set(xlabel=plane.labels[0], ylabel=plane.labels[1], title=plane.place)
    return image


def mark(
    panel: Panel, places: Floats, colour: str, label: str = "samples", alpha: float = 1.0
) -> None:
    """Mark samples at places (K, 2) [m], without a change of the axes' limits."""
    limits = panel.get_xlim(), panel.get_ylim()
    how = {"ms": 5, "mfc": "none"} if len(places) <= MAX_CIRCLES else {"ms": 1, "mfc": colour}
    panel.plot(*(1e3 * places.T), "o", mec=colour, mew=0.8, label=label, alpha=alpha, **how)
    panel.set(xlim=limits[0], ylim=limits[1])


def _compute_direction(array: Array) -> Floats:
    """Return the mean direction of an array, (3,); +z if its transducers face all directions equally."""
    mean = array.normals.mean(axis=0)
    size = np.linalg.norm(mean)
    return np.asarray(mean / size) if size > 1e-6 else np.array([0.0, 0.0, 1.0])


def _half(size: float | tuple[float, float] | None, places: Floats) -> Floats:
    """Half the width and height [m], (2,), unless given so that places about the middle, (M, 2) [m], are held."""
    if size is None:
        return np.full(2, MARGIN + float(np.abs(places).max()) if len(places) else HALF_WIDTH)
    sides = [check_length("size", side) for side in np.atleast_1d(size).tolist()]
    if len(sides) not in (1, 2):
        raise ArgumentError("size", f"must be one length or two [m], not {size!r}")
    return np.array([sides[0], sides[-1]]) / 2.0


def _steps(low: Floats, high: Floats) -> tuple[Floats, Floats]:
    """Coordinates from corner to corner, (2,) [m] each, with equal steps along both."""
    step = float((high - low).max()) / (GRID - 1)
    return (
        np.linspace(low[0], high[0], max(2, round((high[0] - low[0]) / step) + 1)),
        np.linspace(low[1], high[1], max(2, round((high[1] - low[1]) / step) + 1)),
    )
