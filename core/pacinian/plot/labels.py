"""Places labels beside points in a picture, where there is room."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from pacinian.plot.style import SMALL

if TYPE_CHECKING:
    from collections.abc import Sequence

    from pacinian.plot.style import Panel

Text = tuple[str, float, float, str]  # text, x, y, colour

HALO = {"facecolor": "white", "alpha": 0.7, "linewidth": 0, "pad": 0.2}
PLAIN = str.maketrans("", "", "${}^")
# Possible places of a label: lines up, right or left, and distance [lines], nearest first.
LABEL_PLACES = sorted(
    (
        (1.3 * up, right, away)
        for up in range(-7, 8)
        for right in (True, False)
        for away in (0, 2, 4, 8)
    ),
    key=lambda place: abs(place[0]) + 0.7 * place[2] + 0.3 * (not place[1]),
)


def label(panel: Panel, texts: Sequence[Text], others: Sequence[tuple[float, float]] = ()) -> None:
    """Write texts beside their points, each at the first free place near. others: further marked points to avoid."""
    pixel = panel.figure.dpi / 72.0
    size = SMALL * pixel
    places = [(x, y) for _, x, y, _ in texts]
    spots = panel.transData.transform([*places, *others]) if places else []
    low, high = panel.transAxes.transform([(0, 0), (1, 1)])
    taken = [(u - 0.5 * size, v - 0.5 * size, u + 0.5 * size, v + 0.5 * size) for u, v in spots]
    for index in np.argsort([v for _, v in spots[: len(texts)]]):
        (text, x, y, colour), (u, v) = texts[index], spots[index]
        wide = 0.58 * size * len(text.translate(PLAIN))
        for lines, right, away in LABEL_PLACES:
            left = u + (0.8 + away) * size if right else u - (0.8 + away) * size - wide
            box = (left, v + (lines - 0.65) * size, left + wide, v + (lines + 0.65) * size)
            inside = low[0] < box[0] and box[2] < high[0] and low[1] < box[1] and box[3] < high[1]
            if inside and not any(_overlap(box, other) for other in taken):
                break
        else:
            continue  # no room: omit the label
        taken.append(box)
        leader = {"arrowstyle": "-", "color": colour, "linewidth": 0.4} if lines or away else None
        note = panel.annotate(
            text, (x, y), xytext=((left - u) / pixel, lines * SMALL), textcoords="offset points",
            va="center", fontsize=SMALL, color=colour, arrowprops=leader, bbox=HALO,
        )  # fmt: skip
        note.set_in_layout(False)


def label_column(panel: Panel, texts: Sequence[Text]) -> None:
    """Write texts in a column to the right of their points, in the points' order, joined to them by lines."""
    pixel = panel.figure.dpi / 72.0
    step = 1.35 * SMALL * pixel
    spots = panel.transData.transform([(x, y) for _, x, y, _ in texts])
    order = np.argsort(spots[:, 1])
    heights = spots[order, 1].copy()
    for _ in range(500):  # push neighbours apart until none overlap
        gaps = np.diff(heights)
        short = np.maximum(step - gaps, 0.0) / 2.0
        if short.max(initial=0.0) < 0.01:
            break
        heights[1:] += short
        heights[:-1] -= short
    right = spots[:, 0].max() + 3.0 * SMALL * pixel
    for index, height in zip(order, heights, strict=True):
        text, x, y, colour = texts[index]
        u, v = spots[index]
        note = panel.annotate(
            text, (x, y), xytext=((right - u) / pixel, (height - v) / pixel), textcoords="offset points",
            va="center", fontsize=SMALL, color=colour,
            arrowprops={"arrowstyle": "-", "color": colour, "linewidth": 0.4, "relpos": (0.0, 0.5), "shrinkB": 3.0},
        )  # fmt: skip
        note.set_in_layout(False)


def _overlap(a: tuple[float, ...], b: tuple[float, ...]) -> bool:
    return a[0] < b[2] and b[0] < a[2] and a[1] < b[3] and b[1] < a[3]
