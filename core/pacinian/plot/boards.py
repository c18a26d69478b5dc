"""Plots a device's boards: poses, channel order and dead transducers."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from pacinian.plot.page import figure, set_title
from pacinian.plot.style import MAP

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from pacinian.devices.board import Board
    from pacinian.devices.description import DeviceDescription
    from pacinian.types import Floats

ANGLE = 35.0, -60.0  # [deg] elevation and azimuth
DEAD = "#d62728"
MAX_BOARDS = 16  # maximum number of boards drawn one by one
DOT, RING = 0.7, 1.0  # diameters of a dot at full strength and of a ring, over the pitch
ONE_PITCH = 10.0  # pitch of a board of one transducer [mm]
ARROW = 0.06  # [m]
MIN_SIDE = 0.02  # shortest side of the box around all boards, also around a single row [m]
LABEL = {"facecolor": "white", "edgecolor": "none", "pad": 1.0, "alpha": 0.8}


def boards(device: DeviceDescription, title: str = "") -> Figure:
    """Plot all boards in their poses, and the first `MAX_BOARDS` from the front. Raises MissingExtra.

    The colour shows the channel number. The first channel is ringed; dead ones are crossed out. The area of a dot
    shows its strength.
    """
    shown = device.boards[:MAX_BOARDS]
    columns = int(np.ceil(np.sqrt(len(shown))))
    rows = -(-len(shown) // columns)
    page = figure(14.0, 6.4)  # before other imports from Matplotlib, because it raises MissingExtra
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import Normalize

    parts: Any = page.subfigures(1, 2, width_ratios=[1.0, 1.25])
    left, right = parts
    _space(left.add_subplot(projection="3d"), device.boards)
    panels = right.subplots(rows, columns, squeeze=False).ravel()
    for panel in panels[len(shown) :]:
        panel.set_axis_off()
    for i, (panel, board) in enumerate(zip(panels, shown, strict=False)):
        _plan(panel, board)
        if i + columns >= len(shown):
            panel.set_xlabel("x of the board [mm]", fontsize=8)
        if i % columns == 0:
            panel.set_ylabel("y of the board [mm]", fontsize=8)
    if len(shown) < len(device.boards):
        text = f"the first {len(shown)} of {len(device.boards)} boards; the others are only at the left"
        right.suptitle(text, fontsize=8)
    most = max(board.layout.count for board in device.boards) - 1
    scale = ScalarMappable(Normalize(0, most), MAP)
    right.colorbar(scale, ax=panels.tolist(), label="channel", shrink=0.7)
    if title:
        set_title(page, f"{title}: {len(device.array())} transducers")
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
        panel.text(
            *tip, board.serial, ha="center", fontsize=8, bbox=LABEL, zorder=9, parse_math=False
        )
        corners += [r.min(axis=0), r.max(axis=0), middle + way]
    low, high = np.min(corners, axis=0), np.max(corners, axis=0)
    pad = np.maximum(0.0, 0.5 * (MIN_SIDE - (high - low)))
    low, high = 1e3 * (low - pad), 1e3 * (high + pad)
    panel.set_proj_type("ortho")
    panel.view_init(*ANGLE)
    panel.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), zlim=(low[2], high[2]))
    panel.set_box_aspect(high - low, zoom=0.82)
    panel.computed_zorder = False
    for axis, padded in zip("xyz", pad > 0.0, strict=True):
        if padded:
            panel.locator_params(axis=axis, nbins=1)
    panel.locator_params(axis="z", nbins=3)
    panel.tick_params(labelsize=7)
    panel.set(xlabel="x [mm]", ylabel="y [mm]")
    panel.set_zlabel("z [mm]", labelpad=0.0)  # else it overlaps the panels beside


def _plan(panel: Any, board: Board) -> None:
    """Draw one board in its own coordinates, coloured by channel."""
    from matplotlib.collections import LineCollection
    from scipy.spatial import KDTree

    r, strength = 1e3 * board.layout.positions()[board.drives][:, :2], np.abs(board.responses)
    alive, L = board.alive, len(r)
    dead = np.setdiff1d(np.arange(L), alive)
    pitch = float(np.min(KDTree(r).query(r, [2])[0])) if L > 1 else ONE_PITCH
    dots = _circles(panel, r[alive], DOT * pitch * np.sqrt(strength[alive]), cmap=MAP)
    dots.set(array=alive, clim=(0, L - 1))
    _circles(panel, r[:1], np.array([RING * pitch]), facecolors="none", edgecolors="black")
    arm = DOT * pitch / 2.0 * np.array([[-1.0, -1.0], [1.0, 1.0]])
    lines = [place + way * arm for place in r[dead] for way in ([1.0, 1.0], [1.0, -1.0])]
    panel.add_collection(LineCollection(lines, colors=DEAD))
    (left, bottom), (right, top) = r.min(axis=0) - pitch, r.max(axis=0) + pitch
    panel.set(aspect="equal", xlim=(left, right), ylim=(bottom, top))
    panel.tick_params(labelsize=6)
    note = f", {len(dead)} dead" if len(dead) else ""
    panel.set_title(f"{board.serial or 'board'}{note}", fontsize=8, parse_math=False)


def _circles(panel: Any, centres: Floats, sizes: Floats, **style: Any) -> Any:
    """Draw circles with these centres, (K, 2), and diameters, (K,), in data units; return their collection."""
    from matplotlib.collections import EllipseCollection

    made = EllipseCollection(
        sizes, sizes, np.zeros(len(sizes)),
        units="xy", offsets=centres, offset_transform=panel.transData, **style,
    )  # fmt: skip
    panel.add_collection(made)
    return made
