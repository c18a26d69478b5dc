"""Plots the drive of an array: phase and amplitude of each transducer."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal, get_args, overload

import numpy as np

from pacinian.acoustics.array import Array
from pacinian.argument_checks import check_kind
from pacinian.errors import ArgumentError
from pacinian.plot.page import panels
from pacinian.plot.style import COLUMN, CYCLIC, MAP, bar, dress

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from pacinian.plot.style import Panel
    from pacinian.types import ArrayLike, Complexes, Floats

Part = Literal["phase", "amplitude"]

SIDE_MARGIN = 1.1  # for labels and the colour bar [inch]
BOTTOM_MARGIN = 0.4  # for labels [inch]
MIN_HEIGHT, MAX_HEIGHT = 1.3, 4.0  # [inch]
# The discs of transducers have this diameter, or the pitch if that is less [m].
MAX_DISC_DIAMETER = 0.01
OFF = "0.85"  # colour of silent transducers
LABELS = {"phase": "phase [rad]", "amplitude": "amplitude |g| (1: full drive)"}


@overload
def drive(
    array: Array,
    gains: ArrayLike,
    show: Part | None = None,
    *,
    ax: None = None,
) -> Figure: ...
@overload
def drive(
    array: Array,
    gains: ArrayLike,
    show: Part | None = None,
    *,
    ax: Axes,
) -> Axes: ...
@overload
def drive(
    array: Array,
    gains: ArrayLike,
    show: Part | None = None,
    *,
    ax: Sequence[Axes],
) -> Sequence[Axes]: ...
def drive(
    array: Array,
    gains: ArrayLike,
    show: Part | None = None,
    *,
    ax: Axes | Sequence[Axes] | None = None,
) -> Figure | Axes | Sequence[Axes]:
    """Plot the phase and amplitude of each transducer; silent ones are grey.

    gains: (N,). show: "phase" [rad] or "amplitude" only. ax: axes to draw into and return, one per quantity.
    The view is along the axis that most transducers face; those farther along it are drawn last. Raises ArgumentError,
    MissingExtra.
    """
    if show is not None and show not in get_args(Part):
        raise ArgumentError("show", f'must be "phase" or "amplitude", not {show!r}')
    parts = get_args(Part) if show is None else (show,)
    check_kind("array", array, Array)
    g = _gains(array, gains)
    i, j = across(array)
    r = array.positions[:, [i, j]]
    low, high = r.min(axis=0) - MAX_DISC_DIAMETER, r.max(axis=0) + MAX_DISC_DIAMETER
    tall = float((high - low)[1] / (high - low)[0])
    height = float(np.clip(BOTTOM_MARGIN + (COLUMN - SIDE_MARGIN) * tall, MIN_HEIGHT, MAX_HEIGHT))
    page, axes, _ = panels(ax, [height] * len(parts))
    for panel, part in zip(axes, parts, strict=True):
        marks = _marks(panel, array, g, part, (i, j))
        panel.set(xlim=1e3 * np.array([low[0], high[0]]), ylim=1e3 * np.array([low[1], high[1]]))
        panel.set(xlabel=f"{'xyz'[i]} [mm]", ylabel=f"{'xyz'[j]} [mm]", aspect="equal")
        bar(page, marks, panel, LABELS[part])
    return dress(page) if ax is None else ax


def across(array: Array) -> tuple[int, int]:
    """Return which two of x, y, z run across an array, excluding the axis that most transducers face."""
    along = int(np.abs(array.normals).mean(axis=0).argmax())
    i, j = (k for k in range(3) if k != along)
    return i, j


def _gains(array: Array, gains: ArrayLike) -> Complexes:
    g = np.asarray(gains)
    if g.shape != (len(array),) or g.dtype.kind not in "iufc" or not np.isfinite(g).all():
        raise ArgumentError(
            "gains", f"must be {len(array)} finite numbers, not {g.shape} {g.dtype}"
        )
    return g.astype(np.complex128)


def _marks(panel: Panel, array: Array, g: Complexes, part: str, axes: tuple[int, int]) -> Any:
    """Draw a disc of its size for each transducer; return the coloured artist."""
    from matplotlib import colormaps
    from matplotlib.collections import EllipseCollection

    along = 3 - sum(axes)
    order = np.argsort(array.positions[:, along], kind="stable")
    if array.normals[:, along].sum() < 0.0:
        order = order[::-1]
    r, g, size = array.positions[order][:, list(axes)], g[order], np.abs(g[order])
    d = 1e3 * min(MAX_DISC_DIAMETER, _pitch(array.positions))
    discs: Any = EllipseCollection(
        [d], [d], [0.0], units="xy", offsets=1e3 * r, offset_transform=panel.transData, linewidths=0
    )
    if part == "phase":
        discs.set_array(np.ma.masked_where(size == 0.0, np.angle(g)))
        discs.set_clim(-np.pi, np.pi)
    else:
        discs.set_array(size)
        discs.set_clim(0.0, float(size.max()) or 1.0)
    discs.set_cmap(colormaps[CYCLIC if part == "phase" else MAP].with_extremes(bad=OFF))
    panel.add_collection(discs)
    return discs


def _pitch(positions: Floats) -> float:
    """Return the typical distance from a transducer to its nearest neighbour [m]."""
    from scipy.spatial import KDTree

    if len(positions) < 2:
        return MAX_DISC_DIAMETER
    near = np.asarray(KDTree(positions).query(positions, 2)[0])[:, 1]
    return float(np.median(near)) or MAX_DISC_DIAMETER
