"""Plots a device's boards: poses, channel order and dead transducers."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from pacinian.plot.page import figure

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from pacinian.devices.board import Board
    from pacinian.devices.description import DeviceDescription

ANGLE = 35.0, -60.0  # [deg] elevation and azimuth
MAP, DEAD = "viridis", "#d62728"
MAX_BOARDS = 16  # maximum number of boards drawn one by one
DOTS = 210.0  # [pt]
ARROW = 0.06  # [m]
LABEL = {"facecolor": "white", "edgecolor": "none", "pad": 1.0, "alpha": 0.8}


def boards(device: DeviceDescription, title: str = "") -> Figure:
    """Plot all boards in their poses, and each one from the front. Raises MissingExtra.

    The colour shows the channel number. The first channel is ringed; dead ones are crossed out. The area of a dot
    shows its strength.
    """
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import Normalize

    shown = device.boards[:MAX_BOARDS]
    columns = int(np.ceil(np.sqrt(len(shown))))
    rows = -(-len(shown) // columns)
    page = figure(14.0, 6.4)
    parts: Any = page.subfigures(1, 2, width_ratios=[1.0, 1.25])
    left, right = parts
    _space(left.add_subplot(projection="3d"), device.boards)
    panels = right.subplots(rows, columns, squeeze=False).ravel()
    for panel in panels[len(shown) :]:
        panel.set_axis_off()
    for panel, board in zip(panels, shown, strict=False):
        _plan(panel, board, DOTS / columns)
    most = max(board.layout.count for board in device.boards) - 1
    scale = ScalarMappable(Normalize(0, most), MAP)
    right.supxlabel("x of the board [mm]", fontsize=8)
    right.supylabel("y of the board [mm]", fontsize=8)
    right.colorbar(scale, ax=panels.tolist(), label="channel", shrink=0.7)
    if title:
        page.suptitle(f"{title}: {len(device.array())} transducers")
    return page


def _space(panel: Any, boards: tuple[Board, ...]) -> None:
    """Draw all boards in world coordinates; arrows show the direction of the sound."""
    corners: list[Any] = []
    for board in boards:
        r = board.pose.points(board.layout.positions())
        alive = board.drives[board.alive]
        dead = np.setdiff1d(np.arange(len(r)), alive)
        panel.scatter(*(1e3 * r[alive].T), s=5, c=alive, cmap=MAP, depthshade=False)
        panel.scatter(*(1e3 * r[dead].T), s=14, c=DEAD, marker="x", depthshade=False)
        middle = r.mean(axis=0)
        way = board.pose.directions(np.array([0.0, 0.0, ARROW]))
        panel.quiver(*(1e3 * middle), *(1e3 * way), color="black", linewidth=1.2)
        tip = 1e3 * (middle + 1.15 * way)
        panel.text(*tip, board.serial, ha="center", fontsize=8, bbox=LABEL, zorder=9)
        corners += [r.min(axis=0), r.max(axis=0), middle + way]
    low, high = 1e3 * np.min(corners, axis=0), 1e3 * np.max(corners, axis=0)
    panel.set_proj_type("ortho")
    panel.view_init(*ANGLE)
    panel.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), zlim=(low[2], high[2]))
    panel.set_box_aspect(high - low, zoom=0.9)
    panel.computed_zorder = False
    panel.locator_params(axis="z", nbins=3)
    panel.tick_params(labelsize=7)
    panel.set(xlabel="x [mm]", ylabel="y [mm]")


def _plan(panel: Any, board: Board, side: float) -> None:
    """Draw one board in its own coordinates, coloured by channel. side: width shared by its dots [pt]."""
    r, strength = 1e3 * board.layout.positions()[board.drives], np.abs(board.responses)
    alive, L = board.alive, len(r)
    dead = np.setdiff1d(np.arange(L), alive)
    side *= side / L
    panel.scatter(
        r[alive, 0], r[alive, 1], c=alive, s=side * strength[alive], cmap=MAP, vmin=0, vmax=L - 1
    )
    panel.scatter(r[dead, 0], r[dead, 1], c=DEAD, marker="x", s=side)
    panel.scatter(r[:1, 0], r[:1, 1], s=2.5 * side, facecolors="none", edgecolors="black")
    panel.set_aspect("equal")
    panel.tick_params(labelsize=6)
    note = f", {len(dead)} dead" if len(dead) else ""
    panel.set_title(f"{board.serial or 'board'}{note}", fontsize=8)
