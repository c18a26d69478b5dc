"""What the figures are made of: one map, one layout, a colour bar."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from pacinian.plot.style import BLUE, MAP, RED
from pacinian_lab.paper import experiment

if TYPE_CHECKING:
    from collections.abc import Iterable

    from pacinian.plot.style import Panel
    from pacinian.types import Floats


def layout(panel: Panel, name: str) -> None:
    """Transducers and samples of a case, in 3-D (Figure 6)."""
    place = experiment.case(name)
    for points, colour, size in ((place.points, RED, 0.4), (place.array.positions, BLUE, 0.8)):
        panel.scatter(*(1e3 * points.T), s=size, color=colour, linewidths=0, rasterized=True)
    panel.set(xlim=(-200, 200), ylim=(-200, 200), zlim=(0, 400))
    panel.set(xticks=(-150, 0, 150), yticks=(-150, 0, 150), zticks=(0, 200, 400))
    panel.set_box_aspect((1, 1, 1), zoom=1.1)
    panel.view_init(elev=22, azim=-60)
    panel.tick_params(labelsize=7, pad=-3)
    for axis in "xyz":
        getattr(panel, f"set_{axis}label")(f"{axis} [mm]", fontsize=8, labelpad=-7)
    panel.set_title(name, fontsize=12, y=1.02)


def legend(panel: Panel) -> None:
    """What the layouts' colours mean, in a panel of its own."""
    panel.set_axis_off()
    panel.text(0.0, 0.6, "transducers", color=BLUE)
    panel.text(0.0, 0.4, "samples", color=RED)


def draw_map(panel: Panel, amplitude: Floats, region: str, top: float) -> None:
    """|p| in region "1" (x, y) or "2" (y, z); the outer samples' squares reach 5 mm further."""
    low = (-205, -205) if region == "1" else (-205, -5)
    extent = (low[0], low[0] + 410, low[1], low[1] + 410)
    panel.imshow(amplitude, origin="lower", extent=extent, cmap=MAP, vmin=0.0, vmax=top)
    across, up = "xy" if region == "1" else "yz"
    panel.set(xlabel=f"{across} [mm]", ylabel=f"{up} [mm]", xticks=(-200, 0, 200))
    panel.set_yticks((-200, 0, 200) if region == "1" else (0, 200, 400))
    panel.tick_params(labelsize=8)
    panel.yaxis.labelpad = 0


def inner(panels: Iterable[Panel]) -> None:
    """Leave the horizontal axis to the last row."""
    for panel in panels:
        panel.set_xlabel("")
        panel.tick_params(labelbottom=False)


def score(correlation: float, maximum: float) -> str:
    """A map's title."""
    return f"corr. {correlation:.2f}, max {maximum:.2f}"


def colour_bar(figure: Any, panels: list[Panel]) -> None:
    """One colour bar for all panels."""
    label = "|p| / target amplitude"
    figure.colorbar(panels[0].images[0], ax=panels, label=label, shrink=0.6, aspect=35, pad=0.01)
