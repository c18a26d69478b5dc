"""How pictures look: a paper's column, its sizes, and colours that every eye tells apart."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.figure import Figure

Panel = Any  # Matplotlib's axes: its stubs leave too much open

COLUMN = 3.5  # [inch], of a paper with two columns
TEXT, SMALL = 8.0, 7.0  # [pt]: labels; ticks, legends, notes
THIN, LINE = 0.6, 1.0  # [pt]: frames; curves

MAP, CYCLIC = "viridis", "twilight"
# Okabe and Ito's colours.
BLUE, RED, GREEN, PINK, ORANGE = "#0072b2", "#d55e00", "#009e73", "#a8508a", "#e69f00"
GREY = "0.55"
CURVES = (BLUE, RED, GREEN, PINK, ORANGE, "0.2", "#56b4e9", GREY)
MARKS = "os^Dvx+*"


def bar(
    page: Any, image: Any, ax: Panel | Sequence[Panel], label: str, *, below: bool = False
) -> None:
    """A colour bar beside axes, or below; a phase's [rad] has ticks at whole parts of pi."""
    made = page.colorbar(image, ax=ax, label=label, location="bottom" if below else "right")
    if "[rad]" in label:
        made.set_ticks([-math.pi, 0.0, math.pi], labels=["−π", "0", "π"])


def dress(page: Figure) -> Figure:
    """The same figure, with all text and lines of a size for print."""
    for panel in page.axes:
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
    page.draw_without_rendering()  # room for ticks is found at the second time only
    return page
