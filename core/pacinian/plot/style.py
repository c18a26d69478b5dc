"""Style of figures: width of a paper's column, sizes, and colours that are safe for colour-blind readers."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Panel = Any  # Matplotlib's axes: its stubs leave too much open

COLUMN = 3.5  # [inch], of a paper with two columns
TEXT, SMALL = 8.0, 7.0  # [pt]: labels; ticks, legends, notes
THIN, LINE = 0.6, 1.0  # [pt]: frames; curves
MAX_LAYOUT_PASSES = 6  # maximum number of layout passes, until nothing is cut off

MAP, CYCLIC, SAMPLES_MAP = "viridis", "twilight", "inferno"
# The colours of Okabe and Ito.
BLUE, RED, GREEN, PINK, ORANGE = "#0072b2", "#d55e00", "#009e73", "#a8508a", "#e69f00"
GREY = "0.55"
CURVES = (BLUE, RED, GREEN, PINK, ORANGE, "0.2", "#56b4e9", GREY)
MARKS = "os^Dvx+*"
# Colours of arrays, hands and objects in space: red, green and blue, 0..1.
METAL, SKIN, THING = (0.66, 0.68, 0.72), (0.95, 0.80, 0.70), (0.35, 0.58, 0.82)


def bar(
    page: Any, image: Any, ax: Panel | Sequence[Panel], label: str, *, below: bool = False
) -> None:
    """Add a colour bar beside or below the axes, of their size, with an arrow if values exceed its end.

    A bar of phases [rad] has ticks at fractions of pi.
    """
    most = image.get_array().max()
    given: dict[str, Any] = {
        "label": label,
        "extend": "max" if most > image.norm.vmax else "neither",
    }
    if below or isinstance(ax, Sequence):
        made = page.colorbar(image, ax=ax, location="bottom" if below else "right", **given)
    else:
        made = page.colorbar(image, cax=ax.inset_axes((1.04, 0.0, 0.05, 1.0)), **given)
    if "[rad]" in label:
        made.set_ticks([-math.pi, 0.0, math.pi], labels=["−π", "0", "π"])


def dress(page: Figure) -> Figure:
    """Lay the figure out, set text and lines to print sizes, and return it."""
    for panel in (one for axes in page.axes for one in (axes, *axes.child_axes)):
        panel.tick_params(labelsize=SMALL, width=THIN, length=3.0)
        panel.tick_params(which="minor", width=0.6 * THIN, length=1.5)
        for text in (panel.title, panel.xaxis.label, panel.yaxis.label):
            text.set_fontsize(TEXT)
        for frame in panel.spines.values():
            frame.set_linewidth(THIN)
        if (legend := panel.get_legend()) is not None:
            for text in legend.get_texts():
                text.set_fontsize(SMALL)
    for text in page.texts:
        text.set_fontsize(TEXT)
    layout: Any = page.get_layout_engine()
    for _ in range(MAX_LAYOUT_PASSES):  # ticks depend on the room, and the room on the ticks
        layout.execute(page)
        box, (width, height) = page.get_tightbbox(), page.get_size_inches()
        if box.x0 > 0.0 and box.y0 > 0.0 and box.x1 < width and box.y1 < height:
            break
    return page
