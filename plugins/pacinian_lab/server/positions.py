"""Positions of the objects under load. A position encodes when it was sent, so a felt position tells its age.

Objects come in groups of 16. Each object of the felt group moves along x within its own cell, 4 mm in 10 s, again and
again. All other objects move outside of the workspace.
"""

from __future__ import annotations

import numpy as np

from pacinian.wire import binary_arrays, objects

CELLS = 16  # 4 x 4
CELL_SPACING = 0.03  # [m] between cells
HEIGHT = 0.2  # [m]
AWAY = 0.6  # [m], outside of the workspace
WAY, PERIOD = 0.004, 10.0  # [m] in [s]
WITHIN = 1e-6  # rounding of float32 [m]
WORKSPACE = (-0.15, -0.15, 0.05), (0.15, 0.15, 0.4)  # [m]


def name(index: int) -> str:
    """Return the name of an object."""
    return f"point {index}"


def cell(index: int) -> tuple[float, float]:
    """Return where the path of an object starts, x and y [m]."""
    row, column = divmod(index % CELLS, 4)
    return CELL_SPACING * (column - 1.5), CELL_SPACING * (row - 1.5)


def place(index: int, t: float, group: int = 0) -> tuple[float, float, float]:
    """Return the position of an object that is moved at time t [s], when `group` is felt [m]."""
    x, y = cell(index)
    felt = index // CELLS == group
    return x + WAY * (t / PERIOD % 1.0), y, HEIGHT if felt else AWAY


def pose(index: int, t: float, group: int = 0) -> bytes:
    """Return the pose as bytes of the wire."""
    return binary_arrays.pack([*place(index, t, group), 0.0, 0.0, 0.0, 1.0])


def point(index: int, t: float) -> objects.Point:
    """Return the object."""
    return objects.Point(position=place(index, t), radiation_pressure=5.0)


def decode_send_times(points: bytes, now: float) -> dict[int, float]:
    """Return when each felt object was sent [s], by cell. now: a time less than 10 s later [s]."""
    found = dict[int, float]()
    for x, y, _ in binary_arrays.unpack(points, 3).astype(np.float64).tolist():
        row = round(y / CELL_SPACING + 1.5)
        column = round((x - WAY / 2.0) / CELL_SPACING + 1.5)
        number = 4 * row + column
        t = (x - cell(number)[0]) / WAY * PERIOD
        found[number] = now - (now - t) % PERIOD
    return found


def find_missing(points: bytes, indices: range, t: float) -> list[int]:
    """Return the objects that are not felt exactly where they were put at time t [s], when their group is felt."""
    P = binary_arrays.unpack(points, 3).astype(np.float64)
    gone = list[int]()
    for index in indices:
        at = np.array(place(index, t, index // CELLS))
        if not len(P) or np.abs(P - at).max(axis=1).min() > WITHIN:
            gone.append(index)
    return gone
