"""The pictures of shapes."""

from __future__ import annotations

from typing import Any

import pytest

import pacinian as pc
from pacinian_lab.regions.pictures import Picture

pytest.importorskip("matplotlib")


@pytest.mark.parametrize("name", ["disc, 8 mm", "strip, 8 x 30 mm"])
def test_the_legend_of_the_cut_covers_neither_numbers_nor_curves(name: str) -> None:
    page = Picture(pc.autd(), name).draw()
    page.canvas.draw()
    (cut,) = (panel for panel in page.get_axes() if panel.get_title() == "along the middle")
    panel: Any = cut
    legend = panel.get_legend().get_window_extent()
    frame = panel.get_window_extent()
    assert frame.x0 < legend.x0 < legend.x1 < frame.x1
    assert frame.y0 < legend.y0 < legend.y1 < frame.y1
    for line in panel.get_lines():
        assert panel.transData.transform(line.get_xydata())[:, 1].max() < legend.y0
