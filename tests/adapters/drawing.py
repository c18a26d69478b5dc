"""Draws terminals, menus, panels of fields, and an array with a ball and a hand, for the walkthroughs in pictures."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from matplotlib.patches import Circle, FancyBboxPatch, Polygon, Rectangle
from scipy.spatial import ConvexHull

import pacinian as pc
from pacinian.plot import figure

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

INCH = 100.0  # [px] of these drawings
WIDTH = 960.0  # [px] of a picture
LINE = 24.0  # [px] height of a row
MARGIN = 16.0  # [px]
TEXT, SMALL, FINE = 10.5, 9.5, 8.5  # [pt]
MONO = "DejaVu Sans Mono"
DARK, PANEL, FIELD, EDGE = "#10161f", "#f4f5f7", "#ffffff", "#b9c0c9"
INK, GREY, BLUE, PICK, GREEN = "#1b222c", "#6b7480", "#31688e", "#d6e6f5", "#5ec962"
ANGLES = np.linspace(0.0, 2.0 * np.pi, 40, endpoint=False)
AROUND = np.column_stack([np.cos(ANGLES), np.sin(ANGLES)])

Point = tuple[float, float]


class Row(NamedTuple):
    """A row of a panel. kind: text, check, number, choice, object, slider or fold. marked: to be set by the reader."""

    label: str
    value: str = ""
    kind: str = "text"
    marked: bool = False


def make_page(width: float, height: float) -> tuple[Figure, Axes]:
    """Return an empty drawing, width x height [px], whose origin is at the upper left."""
    made = figure(width / INCH, height / INCH)
    made.set_layout_engine("none")
    axes = made.add_axes((0.0, 0.0, 1.0, 1.0))
    axes.set(xlim=(0.0, width), ylim=(height, 0.0), aspect="equal")
    axes.axis("off")
    return made, axes


def write_note(axes: Axes, text: str) -> None:
    """Write at the bottom what the drawing is."""
    low = axes.get_ylim()[0]
    axes.text(MARGIN, low - 8.0, text, fontsize=FINE, color=GREY, va="bottom")


def draw_box(axes: Axes, at: Point, size: Point, fill: str, edge: str = "none") -> None:
    axes.add_patch(
        FancyBboxPatch(
            at,
            *size,
            boxstyle="round,pad=0,rounding_size=4",
            facecolor=fill,
            edgecolor=edge,
            lw=0.8,
        )
    )


def draw_terminal(sessions: Sequence[tuple[str, str]]) -> Figure:
    """Draw a terminal for each command, with what it printed."""
    heights = [LINE * (2 + said.count("\n")) + 2 * MARGIN for _, said in sessions]
    made, axes = make_page(WIDTH, sum(heights) + MARGIN * (len(sessions) + 1))
    top = MARGIN
    for (command, said), height in zip(sessions, heights, strict=True):
        draw_box(axes, (MARGIN, top), (WIDTH - 2 * MARGIN, height), DARK)
        for k, line in enumerate([f"$ {command}", *said.split("\n")]):
            colour = GREEN if k == 0 else "#dfe6ee"
            at = top + MARGIN + LINE * (k + 0.5)
            axes.text(2 * MARGIN, at, line, family=MONO, fontsize=SMALL, color=colour, va="center")
        top += height + MARGIN
    return made


def draw_menu(
    axes: Axes, at: Point, width: float, items: Iterable[str], marked: Sequence[str]
) -> None:
    """Draw a menu; items that the reader chooses are marked, with their order."""
    items = list(items)
    draw_box(axes, at, (width, LINE * len(items) + 12.0), PANEL, EDGE)
    for k, item in enumerate(items):
        x, y = at[0], at[1] + 6.0 + LINE * k
        chosen = item.rstrip(" ▸") in marked
        if chosen:
            draw_box(axes, (x + 4.0, y), (width - 8.0, LINE), PICK)
        axes.text(x + 14.0, y + LINE / 2, item, fontsize=TEXT, color=INK, va="center")
        if chosen and len(marked) > 1:
            draw_badge(axes, (x + width - 18.0, y + LINE / 2), str(marked.index(item) + 1))


def draw_badge(axes: Axes, at: Point, text: str) -> None:
    axes.add_patch(Circle(at, 9.0, color=BLUE))
    axes.text(*at, text, fontsize=FINE, color="white", ha="center", va="center_baseline")


def compute_height(rows: Sequence[Row]) -> float:
    """Return the height of a panel with these rows [px]."""
    return LINE * (len(rows) + 1) + MARGIN


def draw_panel(axes: Axes, at: Point, width: float, title: str, rows: Sequence[Row]) -> None:
    """Draw a panel with fields, as inspectors have."""
    x, y = at
    draw_box(axes, at, (width, compute_height(rows)), PANEL, EDGE)
    axes.text(
        x + 12.0, y + LINE / 2 + 4.0, title, fontsize=TEXT, weight="bold", color=INK, va="center"
    )
    for k, row in enumerate(rows):
        top = y + LINE * (k + 1) + 8.0
        if row.marked:
            draw_box(axes, (x + 4.0, top), (width - 8.0, LINE), PICK)
        fold = "▸ " if row.kind == "fold" else ""
        axes.text(x + 14.0, top + LINE / 2, fold + row.label, fontsize=TEXT, color=INK, va="center")
        _draw_value(axes, row, x + 0.45 * width, top, 0.55 * width - 12.0)


def draw_panels(
    first: tuple[str, Sequence[Row]],
    second: tuple[str, Sequence[Row]],
    about: str,
    hint: Sequence[str] = (),
) -> Figure:
    """Draw two panels side by side, each a title and its rows. hint: lines below the second. about: what it is."""
    left, right = compute_height(first[1]), compute_height(second[1])
    made, axes = make_page(WIDTH, max(left, right + LINE * len(hint)) + 4 * MARGIN)
    half = (WIDTH - 3 * MARGIN) / 2
    draw_panel(axes, (MARGIN, MARGIN), half, *first)
    draw_panel(axes, (2 * MARGIN + half, MARGIN), half, *second)
    for k, line in enumerate(hint):
        y = MARGIN + right + LINE * (k + 1)
        axes.text(3 * MARGIN + half, y, line, fontsize=TEXT, color=INK, va="center")
    write_note(axes, about)
    return made


def _draw_value(axes: Axes, row: Row, x: float, top: float, width: float) -> None:
    middle, text = top + LINE / 2, row.value
    if row.kind == "fold":
        return
    if row.kind == "check":
        draw_box(axes, (x, top + 5.0), (14.0, 14.0), FIELD, EDGE)
        if text:
            axes.plot(
                [x + 3, x + 6, x + 11], [middle, middle + 3.5, middle - 4], color=BLUE, lw=1.8
            )
        return
    if row.kind == "slider":
        x, width = x + 0.2 * width, 0.8 * width  # its label is long
        axes.plot([x, x + width], [middle, middle], color=EDGE, lw=2.0, zorder=1)
        axes.add_patch(Circle((x + float(text) * width, middle), 6.0, color=BLUE))
        return
    if row.kind != "text":
        draw_box(axes, (x, top + 2.0), (width, LINE - 4.0), FIELD, EDGE)
    if row.kind == "choice":
        right = x + width - 16.0
        corners = [(right, middle - 2.5), (right + 8.0, middle - 2.5), (right + 4.0, middle + 3.0)]
        axes.add_patch(Polygon(corners, color=GREY))
    if row.kind == "object":
        axes.add_patch(Circle((x + width - 11.0, middle), 4.5, fill=False, color=GREY))
    indent = 0.0 if row.kind == "text" else 8.0
    axes.text(x + indent, middle, text, fontsize=TEXT, color=INK, va="center")


def draw_place(heights: dict[str, float], unit: str, axis: str) -> Figure:
    """Draw the array, a ball and a hand above it, from the side and to scale.

    heights: of the ball's middle and of the palm above the array, in a unit. axis: the name of the upward one.
    """
    made, axes = make_page(WIDTH, 450.0)
    write_note(axes, "Drawn to scale, from the side.")
    scale, middle, floor = 1500.0, 400.0, 370.0  # [px/m], [px], [px]
    ball, palm = (0.01 * h if unit == "cm" else h for h in heights.values())

    def at(y: float, z: float) -> Point:
        return middle + scale * y, floor - scale * z

    units = pc.autd(3, 3)
    rows = np.unique(units.positions[:, 1].round(6))
    rows = rows - rows.mean()
    left, right = at(rows[0], 0.0), at(rows[-1], 0.0)
    axes.add_patch(Rectangle((left[0] - 8, floor), right[0] - left[0] + 16, 14, color=EDGE))
    axes.plot(*np.array([at(y, 0.0) for y in rows]).T, "o", ms=4, color=BLUE)
    hand = pc.Hand.open("right", pc.Pose((0.0, 0.0, palm)))
    assert hand.radii is not None
    circles = [
        np.array(at(*joint[1:])) + scale * radius * AROUND
        for joint, radius in zip(hand.joints, hand.radii, strict=True)
    ]
    for colour, width in (
        ("#a67c5b", 2.5),
        ("#e2bd9c", 0.0),
    ):  # the outline, and the skin before it
        for pair in _list_bones():
            corners = np.concatenate([circles[k] for k in pair])
            corners = corners[ConvexHull(corners).vertices]
            axes.add_patch(Polygon(corners, facecolor=colour, edgecolor=colour, lw=width))
    axes.add_patch(Circle(at(0.0, ball), scale * 0.03, facecolor="#31688e99", edgecolor=BLUE))
    for label, height, x in (
        (f"ball: {axis} = {heights['ball']:g} {unit}", ball, 0.2),
        (f"palm: {axis} = {heights['palm']:g} {unit}", palm, 0.2),
    ):
        axes.plot(*np.array([at(0.0, height), at(x, height)]).T, color=INK, lw=0.8, ls=":")
        axes.text(*at(x + 0.005, height), label, fontsize=TEXT, color=INK, va="center")
    axes.annotate("", at(-0.2, 0.12), at(-0.2, 0.0), arrowprops={"arrowstyle": "->", "color": BLUE})
    axes.text(
        *at(-0.2, 0.125), f"{axis}: the sound goes up", fontsize=TEXT, color=BLUE, ha="center"
    )
    axes.text(
        middle, floor + 28, "Haptic Array", fontsize=TEXT, color=INK, ha="center", va="center"
    )
    return made


def _list_bones() -> list[tuple[int, int]]:
    """Return the joints that bones connect, in OpenXR's order."""
    fingers = [range(2, 6), *(range(k, k + 5) for k in (6, 11, 16, 21))]
    return [
        (0, 1),
        *((1, finger[0]) for finger in fingers),
        *(p for f in fingers for p in pairwise(f)),
    ]
