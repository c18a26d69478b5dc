"""A figure that notebooks show with or without pyplot."""

from __future__ import annotations

from io import BytesIO
from typing import Any

from matplotlib.figure import Figure

from pacinian.plot.style import CURVES

SHARP = 200.0  # resolution of the image for notebooks [1/inch]
SHOWN_DPI = 110.0  # resolution at which a notebook displays it [1/inch]


class NotebookFigure(Figure):
    """A Matplotlib figure that needs neither pyplot nor a display, with Pacinian's colours for curves."""

    def add_subplot(self, *args: Any, **kwargs: Any) -> Any:
        """Add axes, as in Matplotlib."""
        panel = super().add_subplot(*args, **kwargs)
        panel.set_prop_cycle(color=CURVES)
        return panel

    def _repr_png_(self) -> tuple[bytes, dict[str, int]]:
        buffer = BytesIO()
        self.savefig(buffer, format="png", dpi=SHARP)
        width, height = (round(SHOWN_DPI * side) for side in self.get_size_inches())
        return buffer.getvalue(), {"width": width, "height": height}
