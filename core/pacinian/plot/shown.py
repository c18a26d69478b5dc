"""A figure that notebooks show, whether pyplot is there or not."""

from __future__ import annotations

from io import BytesIO
from typing import Any

from matplotlib.figure import Figure

from pacinian.plot.style import CURVES

SHARP = 200.0  # [1/inch] of the picture that a notebook gets
SHOWN = 110.0  # [1/inch] at which it shows it


class Shown(Figure):
    """A Matplotlib figure, without pyplot and without a display; its curves have our colours."""

    def add_subplot(self, *args: Any, **kwargs: Any) -> Any:
        """As Matplotlib's."""
        panel = super().add_subplot(*args, **kwargs)
        panel.set_prop_cycle(color=CURVES)
        return panel

    def _repr_png_(self) -> tuple[bytes, dict[str, int]]:
        buffer = BytesIO()
        self.savefig(buffer, format="png", dpi=SHARP)
        width, height = (round(SHOWN * side) for side in self.get_size_inches())
        return buffer.getvalue(), {"width": width, "height": height}
