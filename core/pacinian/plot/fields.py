"""Plots the field in one plane, or in the two most informative planes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, overload

import numpy as np

from pacinian.acoustics.array import Array
from pacinian.acoustics.propagation import check_medium
from pacinian.argument_checks import check_kind, check_numbers
from pacinian.plot.page import figure, panels, set_title
from pacinian.plot.planes import MAX_PLANE_DISTANCE, cut, draw, mark, middle_of
from pacinian.plot.quantities import (
    QUANTITIES,
    compute_colour_limits,
    compute_quantity,
    find_distant_points,
)
from pacinian.plot.style import COLUMN, bar, dress

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from pacinian.acoustics.air import Air
    from pacinian.acoustics.pose import Pose
    from pacinian.plot.planes import Plane
    from pacinian.plot.quantities import Show
    from pacinian.plot.style import Panel
    from pacinian.types import ArrayLike, Floats

NONE = np.empty((0, 3))
ABOVE = 1.5  # end of the colour scale, over the largest pressure at the points
AWAY_ALPHA = 0.35  # opacity of the marks of points away from a horizontal slice
TITLE_PAD = 0.07  # [inch] around panels below a title
LABELS, BESIDE, BELOW = 0.6, 1.25, 0.6  # [inch] for labels; with a colour bar; and for a title
TALLEST = 5.0  # [inch]
MIN_FLAT_RATIO = 1.5  # width over height, from which a colour bar is below


@overload
def field(
    array: Array,
    gains: ArrayLike,
    plane: str | Pose = "xz",
    at: ArrayLike | None = None,
    *,
    show: Show = "radiation",
    points: ArrayLike = NONE,
    size: float | tuple[float, float] | None = None,
    medium: Air,
    ax: None = None,
) -> Figure: ...
@overload
def field(
    array: Array,
    gains: ArrayLike,
    plane: str | Pose = "xz",
    at: ArrayLike | None = None,
    *,
    show: Show = "radiation",
    points: ArrayLike = NONE,
    size: float | tuple[float, float] | None = None,
    medium: Air,
    ax: Axes,
) -> Axes: ...
def field(
    array: Array,
    gains: ArrayLike,
    plane: str | Pose = "xz",
    at: ArrayLike | None = None,
    *,
    show: Show = "radiation",
    points: ArrayLike = NONE,
    size: float | tuple[float, float] | None = None,
    medium: Air,
    ax: Axes | None = None,
) -> Figure | Axes:
    """Plot a slice of the field with its colour bar.

    array, gains: (N,), or (K, N) for the mean power over K moments. plane: "xy", "xz" or "yz" through `at`, (3,) [m],
    or a pose, whose xy-plane is used. show: "radiation" pressure on skin [Pa], sound "pressure" [Pa], its "level"
    [dB re 20 µPa], or "phase" [rad]. points: (M, 3) [m], marked if they are close to the plane; by default, `at` is
    their middle and the slice contains them all. size: of a square, or width and height [m]. medium: the air.
    ax: axes to draw into and return. The colour scale ends at the maximum farther than a wavelength from transducers.
    Raises ArgumentError, MissingExtra.
    """
    check_array_and_medium(array, medium)
    q = check_numbers("points", points, (None, 3))
    where = cut(array, plane, at, q, size)
    found = compute_quantity(array, gains, where.points, medium, show)
    flat, height = fit_column(where)
    page, (panel,), _ = panels(ax, [height])
    ends = compute_colour_limits(found, find_distant_points(array, where.points, medium), show)
    image = draw(panel, where, found, show, ends)
    places, near = where.project(q)
    mark(panel, places[near], QUANTITIES[show].marks)
    bar(page, image, panel, QUANTITIES[show].label, below=flat)
    return dress(page) if ax is None else ax


def fit_column(plane: Plane) -> tuple[bool, float]:
    """Return whether the colour bar is below the plane, and the height of a figure as wide as a column [inch]."""
    flat = plane.ratio > MIN_FLAT_RATIO
    wide = COLUMN - (LABELS if flat else BESIDE)
    return flat, min(TALLEST, BELOW + (BESIDE - LABELS) * flat + wide / plane.ratio)


def slices(
    array: Array, gains: ArrayLike, points: ArrayLike, medium: Air, title: str = ""
) -> Figure:
    """Plot the radiation pressure on skin in two planes through the points.

    The planes are a horizontal slice at the mean height of the points and a vertical one through the strongest point.
    array, gains: (N,), or (K, N) for the mean over K moments. points: target positions [m], (M, 3). medium: the air.
    Raises ArgumentError, MissingExtra.
    """
    check_array_and_medium(array, medium)
    q = check_numbers("points", points, (None, 3))
    both = cut_both(array, gains, q, medium)
    narrow = both[1][0].ratio
    page = figure(1.6 + 4.4 * (1.0 + narrow), 4.8)
    axes = page.subplots(1, 2, width_ratios=[1.0, narrow])
    draw_both(page, array, gains, axes, both, q, medium)
    if title:
        set_title(page, title)
        layout: Any = page.get_layout_engine()
        layout.set(h_pad=TITLE_PAD)  # else it touches the titles of the panels
    return page


def cut_both(
    array: Array, gains: ArrayLike, points: Floats, medium: Air
) -> list[tuple[Plane, Floats]]:
    """Return a horizontal and a vertical plane, as in `slices`, each with its radiation pressure [Pa]."""
    middle = middle_of(array, points)
    through = middle.copy()
    if len(points):
        strongest = compute_quantity(array, gains, points, medium, "radiation").argmax()
        through[1] = points[strongest, 1]
    both = cut(array, "xy", middle, points, None), cut(array, "xz", through, points, None)
    return [
        (plane, compute_quantity(array, gains, plane.points, medium, "radiation")) for plane in both
    ]


def draw_both(
    page: Any,
    array: Array,
    gains: ArrayLike,
    panels: Sequence[Panel],
    both: Sequence[tuple[Plane, Floats]],
    points: Floats,
    medium: Air,
    top: float | None = None,
) -> None:
    """Draw planes into panels with a common colour scale, and mark the points, (M, 3) [m].

    top: end of the scale [Pa]. By default, and with points, it is slightly above the pressure at them, because behind
    a surface the pressure may be far higher.
    """
    image, radiation = None, QUANTITIES["radiation"]
    ends = max(
        compute_colour_limits(P, find_distant_points(array, plane.points, medium), "radiation")
        for plane, P in both
    )
    if (
        len(points)
        and (felt := compute_quantity(array, gains, points, medium, "radiation").max()) > 0.0
    ):
        ends = ends[0], min(ends[1], ABOVE * float(felt))
    if top is not None:
        ends = ends[0], top
    for panel, (plane, P) in zip(panels, both, strict=True):
        image = draw(panel, plane, P, "radiation", ends)
        places, near = plane.project(points)
        mark(panel, places[near], radiation.marks)
        if plane.axes == (0, 1) and not near.all():
            away = f"samples more than {1e3 * MAX_PLANE_DISTANCE:g} mm away"
            mark(panel, places[~near], radiation.marks, away, AWAY_ALPHA)
    if len(points):
        panels[0].legend(loc="upper right", framealpha=0.5)
    bar(page, image, list(panels), radiation.label)


def check_array_and_medium(array: Array, medium: Air) -> None:
    """Refuse what is no array, and a medium that is missing. Raises ArgumentError."""
    check_kind("array", array, Array)
    check_medium(medium)
